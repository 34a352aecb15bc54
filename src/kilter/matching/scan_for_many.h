// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "kilter/matching/scan_clusters.h"

namespace kilter {

/// Points that lie near each other and ask together, a lane for each, with what each has found yet. Lanes behind
/// `count` repeat the last one.
struct AskingPoints {
  using Floats = std::array<float, kMostLanes>;

  alignas(64) Floats x{};
  Floats y{};
  Floats z{};
  Floats square_m2{};                             ///< to the nearest, or the squared limit
  std::array<std::int32_t, kMostLanes> number{};  ///< of the nearest; ClusteredPoints::kNoNumber: none yet
  FloatBox box;                                   ///< around them
  float farthest_m2 = 0.0F;                       ///< the largest of square_m2
  std::uint32_t count = 0;
};

/// Looks through clusters for a point nearer to each of `asking` than what it has, or as near with a lower number. The
/// answer for each is that of ScanClusters, to the bit.
using ScanForMany = void (*)(const ClusteredPoints& points, std::span<const ClusterGroup> groups, AskingPoints& asking);

/// All of them do the same operations on each pair of points in the same precision.
[[nodiscard]] ScanForMany scan_for_many_with(VectorPath path);

}  // namespace kilter
