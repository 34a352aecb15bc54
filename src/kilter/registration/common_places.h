// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kilter/geometry/pose3.h"
#include "kilter/matching/pair_grain.h"
#include "kilter/occupancy/voxel_map.h"
#include "kilter/registration/normal_equations.h"

namespace kilter {

/// Edge of the cells that disagreements are taken over. [m]
inline constexpr double kPlace_m = 0.3;

/// The same where voxels are not small beside it: two of them. [m]
[[nodiscard]] double place_edge_m(const PairGrain& grain);

/// The time of a submap (SurfaceVoxels::seen_at) in so many bins.
inline constexpr std::size_t kTimeBins = 12;

[[nodiscard]] inline std::size_t time_bin(std::uint8_t seen_at) { return seen_at * kTimeBins / 256; }

/// How much of what was seen was seen in each bin of time; adds up to 1.
using ShareOfTime = std::array<float, kTimeBins>;

/// A cell where both submaps saw something. All count alike: dense and sparse surfaces by their size, and not by how
/// near the sensors came.
struct CommonPlace {
  /// Mean of what was seen there, where the pose has it; target frame.
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
  ShareOfTime source{};  ///< when the source saw it
  ShareOfTime target{};  ///< and when the target did
};

/// How places lie: their mean and their second moments about it.
struct PlaceMoments {
  std::size_t count = 0;
  Eigen::Vector3d mean_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d scatter_m2 = Eigen::Matrix3d::Zero();
};

/// Where residuals lie, each of which both saw once. O(residuals).
[[nodiscard]] std::vector<CommonPlace> places_of(std::span<const PlaneResidual> residuals, double edge_m);

/// A small motion, by which what a submap saw at some time moves on top of a pose. Target frame.
struct SmallMotion {
  Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();  ///< at the frame's origin
  Eigen::Vector3d turn_rad = Eigen::Vector3d::Zero();

  [[nodiscard]] Eigen::Vector3d of(const Eigen::Vector3d& at_m) const { return shift_m + turn_rad.cross(at_m); }
};

/// Those of two submaps, by bin of time.
struct MotionsInTime {
  std::array<SmallMotion, kTimeBins> source;
  std::array<SmallMotion, kTimeBins> target;
};

/// The places that both maps show once the motions have moved what either saw, on top of the pose, to where it belongs:
/// near and far, walls and leaves alike, whether or not they fix anything. A wall that a slip inside a submap draws
/// twice is one place, of which it saw some before and some after, by the hits of its voxels. (A voxel that was hit
/// before and after has one time, the mean.) Places stand where the pose alone has them. Cells are those of a lattice
/// whose borders lie, on each axis, where the target shows least, or a floor on a border would count twice or, a
/// millimetre apart, not at all. Memory: 200 bytes a place of the target. Cost: one look into a table for each voxel of
/// both.
[[nodiscard]] std::vector<CommonPlace> common_places(const VoxelMap& source, const VoxelMap& target,
                                                     const Pose3& T_target_source, const MotionsInTime& motions,
                                                     double edge_m);

[[nodiscard]] PlaceMoments moments_of(std::span<const CommonPlace> places);

}  // namespace kilter
