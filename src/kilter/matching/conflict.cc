// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/conflict.h"

#include <algorithm>
#include <array>

namespace kilter {

bool is_free_with_neighbours(const VoxelMap& map, const VoxelIndex& voxel) {
  if (map.state(voxel) != CellState::kFree) return false;
  static const std::array<VoxelIndex, 6> kFaces = {VoxelIndex(1, 0, 0),  VoxelIndex(-1, 0, 0), VoxelIndex(0, 1, 0),
                                                   VoxelIndex(0, -1, 0), VoxelIndex(0, 0, 1),  VoxelIndex(0, 0, -1)};
  return std::all_of(kFaces.begin(), kFaces.end(),
                     [&](const VoxelIndex& face) { return map.state(voxel + face) == CellState::kFree; });
}

namespace {

ConflictCount count_conflict(const VoxelMap& surface, const NearestVoxelSearch& space, const Pose3& T_space_surface,
                             double margin_m, std::size_t stride) {
  ConflictCount count;
  if (!space.map().has_free_space()) return count;
  const Eigen::Isometry3d T = T_space_surface.isometry();
  NearestVoxelCursor nearest(space);
  for (std::size_t i = 0; i < surface.voxels().size(); i += stride) {
    const Eigen::Vector3d at_m = T * surface.voxels().centroids_m[i].cast<double>();
    const VoxelIndex voxel = voxel_at(at_m, space.map().resolution_m());
    const bool free = is_free_with_neighbours(space.map(), voxel);
    if (nearest.nearest(at_m, margin_m)) {
      ++count.known;
    } else if (free) {
      ++count.known;
      ++count.conflicting;
    }
  }
  return count;
}

}  // namespace

ConflictSample measure_conflict(const NearestVoxelSearch& source, const NearestVoxelSearch& target,
                                const Pose3& T_target_source, double margin_m, std::size_t stride) {
  return {count_conflict(source.map(), target, T_target_source, margin_m, stride),
          count_conflict(target.map(), source, T_target_source.inverse(), margin_m, stride)};
}

}  // namespace kilter
