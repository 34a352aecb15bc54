// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "kilter/geometry/pose3.h"
#include "kilter/occupancy/block_index.h"
#include "kilter/occupancy/voxel_map.h"

namespace kilter {

/// At most a few of a map's blocks that hold a surface, as points.
struct CoarseCells {
  std::vector<Eigen::Vector3d> centres_m;  ///< mean centroid of the block's voxels, in the map's frame
  std::vector<double> weights;             ///< voxels it stands for
};

/// A map seen from afar: what it takes to tell whether two could show one place, in little memory, so that all of a
/// mission's can be held when their voxels cannot.
class CoarseMap {
 public:
  CoarseMap() = default;
  /// At most `max_cells` cells, evenly picked in block order; weights are scaled so that their sum stays the map's
  /// number of voxels.
  CoarseMap(const VoxelMap& map, std::size_t max_cells);

  [[nodiscard]] const CoarseCells& cells() const { return cells_; }
  /// Box around the map's occupied voxels; empty box if there is none. [m]
  [[nodiscard]] const Eigen::AlignedBox3d& bounds_m() const { return bounds_m_; }
  /// Edge of a block. [m]
  [[nodiscard]] double block_m() const { return kBlockSize * resolution_m_; }
  /// Whether a surface is in one of the eight blocks whose centres surround a point of the map's frame.
  [[nodiscard]] bool surface_near(const Eigen::Vector3d& at_m) const;

 private:
  CoarseCells cells_;
  Eigen::AlignedBox3d bounds_m_;
  double resolution_m_ = 0.1;
  BlockIndex filled_;  // blocks that hold a surface
};

/// What a coarse comparison expects at one relative pose.
struct CoarseOverlap {
  double overlap = 0.0;  ///< matched weight / weight inside the target's box
  double matched = 0.0;  ///< voxels expected to match
  Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();
};

/// Overlap at T_target_source moved by `shift_m` (target frame). Neighbouring blocks count as met.
[[nodiscard]] CoarseOverlap coarse_overlap(const CoarseMap& source, const CoarseMap& target,
                                           const Pose3& T_target_source, const Eigen::Vector3d& shift_m);

/// The best of all shifts on a horizontal grid (two blocks apart) within `reach_m`, the unshifted pose first; ties go
/// to the smaller shift.
/// \param up_target  the world's vertical in the target's frame, of length 1
[[nodiscard]] CoarseOverlap best_coarse_overlap(const CoarseMap& source, const CoarseMap& target,
                                                const Pose3& T_target_source, double reach_m,
                                                const Eigen::Vector3d& up_target);

}  // namespace kilter
