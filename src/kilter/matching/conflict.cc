// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/conflict.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "kilter/matching/pair_grain.h"

namespace kilter {

double conflict_margin_m(const NearestVoxelSearch& source, const NearestVoxelSearch& target) {
  return std::min({kConflictMarginVoxels * grain_of(source.map(), target.map()).edge_m, source.max_distance_m(),
                   target.max_distance_m()});
}

bool is_free_with_neighbours(const VoxelMap& map, const VoxelIndex& voxel) {
  if (map.state(voxel) != CellState::kFree) return false;
  static const std::array<VoxelIndex, 6> kFaces = {VoxelIndex(1, 0, 0),  VoxelIndex(-1, 0, 0), VoxelIndex(0, 1, 0),
                                                   VoxelIndex(0, -1, 0), VoxelIndex(0, 0, 1),  VoxelIndex(0, 0, -1)};
  return std::all_of(kFaces.begin(), kFaces.end(),
                     [&](const VoxelIndex& face) { return map.state(voxel + face) == CellState::kFree; });
}

namespace {

// `near` says whether voxel i, which is at `at_m` in the space's frame, has a surface near it.
template <typename IsNear>
ConflictCount count_conflict(const VoxelMap& surface, const VoxelMap& space, const Pose3& T_space_surface,
                             std::size_t stride, const IsNear& is_near) {
  ConflictCount count;
  if (!space.has_free_space()) return count;
  const Eigen::Isometry3d T = T_space_surface.isometry();
  for (std::size_t i = 0; i < surface.voxels().size(); i += stride) {
    const Eigen::Vector3d at_m = T * surface.voxels().centroids_m[i].cast<double>();
    if (!on_lattice(at_m, space.resolution_m())) continue;
    const VoxelIndex voxel = voxel_at(at_m, space.resolution_m());
    if (is_near(i, at_m, voxel)) {
      ++count.known;
    } else if (is_free_with_neighbours(space, voxel)) {
      ++count.known;
      ++count.conflicting;
    }
  }
  return count;
}

ConflictCount count_conflict(const VoxelMap& surface, const VoxelMap& space, const Pose3& T_space_surface,
                             const std::vector<NearestVoxel>& near) {
  return count_conflict(surface, space, T_space_surface, 1,
                        [&](std::size_t i, const auto&, const auto&) { return near[i].voxel != kNoVoxel; });
}

ConflictCount sample_conflict(const VoxelMap& surface, NearestVoxelCursor& space, const Pose3& T_space_surface,
                              double margin_m, std::size_t stride) {
  // Two points of one voxel are no farther apart than its diagonal.
  const bool own_voxel_is_near = margin_m >= std::sqrt(3.0) * space.map().resolution_m();
  const auto is_near = [&](std::size_t, const Eigen::Vector3d& at_m, const VoxelIndex& voxel) {
    return (own_voxel_is_near && space.map().state(voxel) == CellState::kOccupied) ||
           space.nearest(at_m, margin_m).has_value();
  };
  return count_conflict(surface, space.map(), T_space_surface, stride, is_near);
}

}  // namespace

ConflictSample measure_conflict(const VoxelMap& source, const VoxelMap& target, const Pose3& T_target_source,
                                const NearestBothWays& near) {
  return {count_conflict(source, target, T_target_source, near.forward),
          count_conflict(target, source, T_target_source.inverse(), near.backward)};
}

ConflictSample sample_conflict(NearestVoxelCursor& source, NearestVoxelCursor& target, const Pose3& T_target_source,
                               double margin_m, std::size_t stride) {
  return {sample_conflict(source.map(), target, T_target_source, margin_m, stride),
          sample_conflict(target.map(), source, T_target_source.inverse(), margin_m, stride)};
}

}  // namespace kilter
