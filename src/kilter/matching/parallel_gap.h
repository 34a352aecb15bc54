// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>

#include "kilter/geometry/pose3.h"
#include "kilter/occupancy/voxel_map.h"

namespace kilter {

/// How far apart two submaps put surfaces that face the same way: the double wall that people look for by eye.
struct ParallelGap {
  double gap_m = 0.0;  ///< between the two layers, along their normal
  double sigma_m =
      0.0;  ///< standard deviation of gap_m: the cells' spread, a twentieth of a voxel, and what PairGrain says
  double p_value = 1.0;  ///< two-sided, for "one layer", corrected for the number of directions tried
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit, target axes; the sign is arbitrary
  std::size_t cells = 0;                             ///< cells of a metre that show this direction

  static constexpr double kMost_m = 0.5;  ///< no layer is looked for farther off
};

/// Measures it at one relative pose, without registration.
///
/// A source voxel of a plane meets the target's planar voxels that face the same way and lie along its normal, at most
/// half a metre off; the nearest layer of them gives its signed distance s. The median of s over a cell of a metre
/// is one observation; the median over the cells of one direction (normals within 18 degrees, either sign) is that
/// direction's gap, its spread over the cells its uncertainty. A direction whose cells disagree among each other (a
/// turned wall, or surfaces that are not the same) has none. Of the directions whose gap differs from zero at 1 % the
/// one with the largest gap is returned, else the one with most cells.
/// Where a map has no free space nobody knows which way its surfaces face: the two sides of a thin wall then count as
/// two layers, and a direction in which they prevail shows the wall's thickness.
/// \return  nothing where no direction has six cells. O(source voxels), about 6000 of them.
[[nodiscard]] std::optional<ParallelGap> measure_parallel_gap(const VoxelMap& source, const VoxelMap& target,
                                                              const Pose3& T_target_source);

}  // namespace kilter
