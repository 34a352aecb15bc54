// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kilter/matching/scan_clusters.h"

namespace kilter {

/// Points that lie near each other and ask together, a lane for each, with what each has found yet. Lanes behind
/// `count` repeat the last one.
struct AskingPoints {
  using Floats = std::array<float, kMostLanes>;
  using Doubles = std::array<double, kMostLanes>;

  alignas(64) std::array<Doubles, 3> at_m{};      ///< by axis
  std::array<Floats, 3> rounded_m{};              ///< the same, which is what is searched with
  Floats square_m2{};                             ///< to the nearest, or the squared limit
  std::array<std::int32_t, kMostLanes> number{};  ///< of the nearest; ClusteredPoints::kNoNumber: none yet
  FloatBox box;                                   ///< around them
  float farthest_m2 = 0.0F;                       ///< the largest of square_m2
  std::uint32_t count = 0;
};

/// What a search for many points is made of. All paths do the same operations on each element in the same precision.
struct ManySearchKernels {
  /// Adds those of clusters [first, end) whose square distance from a box is above one bound and at most the other.
  void (*pick)(const ClusterBoxes& boxes, std::uint32_t first, std::uint32_t end, const FloatBox& box, float above_m2,
               float at_most_m2, std::vector<ClusterGroup>& groups);
  /// Brings at_m into another frame, and sets the box and what is rounded.
  void (*move)(const Eigen::Isometry3d& T, AskingPoints& asking);
  /// Sets square_m2 and farthest_m2 by the points that `number` names; lanes that are farther than farthest_m2 was have
  /// found nothing.
  void (*begin)(const ClusteredPoints& points, AskingPoints& asking);
  /// Looks through clusters for a point nearer to each of `asking` than what it has, or as near with a lower number.
  /// The answer for each is that of ScanClusters, to the bit.
  void (*scan)(const ClusteredPoints& points, std::span<const ClusterGroup> groups, AskingPoints& asking);
};

[[nodiscard]] ManySearchKernels many_search_kernels(VectorPath path);

}  // namespace kilter
