// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "kilter/geometry/pose3.h"
#include "kilter/occupancy/voxel_map.h"

namespace kilter {

/// A submap seen from afar: one point for each block that holds a surface.
struct CoarseCells {
  std::vector<Eigen::Vector3d> centres_m;  ///< mean centroid of the block's voxels, in the map's frame
  std::vector<double> weights;             ///< voxels it stands for
};

/// At most `max_cells` cells, evenly picked in block order; weights are scaled so that their sum stays the map's
/// number of voxels.
[[nodiscard]] CoarseCells coarse_cells(const VoxelMap& map, std::size_t max_cells);

/// What a coarse comparison expects at one relative pose.
struct CoarseOverlap {
  double overlap = 0.0;  ///< matched weight / weight inside the target's box
  double matched = 0.0;  ///< voxels expected to match
  Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();
};

/// Overlap at T_target_source moved by `shift_m` (target frame). Neighbouring blocks count as met.
[[nodiscard]] CoarseOverlap coarse_overlap(const CoarseCells& source, const VoxelMap& target,
                                           const Pose3& T_target_source, const Eigen::Vector3d& shift_m);

/// The best of all shifts on a horizontal grid (two blocks apart) within `reach_m`, the unshifted pose first; ties go
/// to the smaller shift. "Horizontal" is the target's x-y plane.
[[nodiscard]] CoarseOverlap best_coarse_overlap(const CoarseCells& source, const VoxelMap& target,
                                                const Pose3& T_target_source, double reach_m);

}  // namespace kilter
