// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/conflict.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace kilter {

bool is_free_with_neighbours(const VoxelMap& map, const VoxelIndex& voxel) {
  if (map.state(voxel) != CellState::kFree) return false;
  static const std::array<VoxelIndex, 6> kFaces = {VoxelIndex(1, 0, 0),  VoxelIndex(-1, 0, 0), VoxelIndex(0, 1, 0),
                                                   VoxelIndex(0, -1, 0), VoxelIndex(0, 0, 1),  VoxelIndex(0, 0, -1)};
  return std::all_of(kFaces.begin(), kFaces.end(),
                     [&](const VoxelIndex& face) { return map.state(voxel + face) == CellState::kFree; });
}

namespace {

ConflictCount count_conflict(const VoxelMap& surface, NearestVoxelCursor& space, const Pose3& T_space_surface,
                             double margin_m, std::size_t stride) {
  ConflictCount count;
  if (!space.map().has_free_space()) return count;
  const Eigen::Isometry3d T = T_space_surface.isometry();
  const double resolution_m = space.map().resolution_m();
  // Two points of one voxel are no farther apart than its diagonal.
  const bool own_voxel_is_near = margin_m >= std::sqrt(3.0) * resolution_m;
  for (std::size_t i = 0; i < surface.voxels().size(); i += stride) {
    const Eigen::Vector3d at_m = T * surface.voxels().centroids_m[i].cast<double>();
    const VoxelIndex voxel = voxel_at(at_m, resolution_m);
    const bool inside = own_voxel_is_near && space.map().state(voxel) == CellState::kOccupied;
    if (inside || space.nearest(at_m, margin_m)) {
      ++count.known;
    } else if (is_free_with_neighbours(space.map(), voxel)) {
      ++count.known;
      ++count.conflicting;
    }
  }
  return count;
}

}  // namespace

ConflictSample measure_conflict(NearestVoxelCursor& source, NearestVoxelCursor& target, const Pose3& T_target_source,
                                double margin_m, std::size_t stride) {
  return {count_conflict(source.map(), target, T_target_source, margin_m, stride),
          count_conflict(target.map(), source, T_target_source.inverse(), margin_m, stride)};
}

}  // namespace kilter
