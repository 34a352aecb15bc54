// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <cstring>

#include "kilter/matching/registers.h"
#include "kilter/matching/scan_clusters.h"

namespace kilter {

/// Adds the square of the gap on one axis: the larger of the ways to a box that lies above and to one that lies below,
/// nothing where they meet.
template <std::uint32_t kLanes>
[[gnu::always_inline]] inline void add_square_gap(const typename Register<kLanes>::Floats& below,
                                                  const typename Register<kLanes>::Floats& above,
                                                  typename Register<kLanes>::Floats& sum_m2) {
  typename Register<kLanes>::Floats gap = below > above ? below : above;
  gap = gap > 0.0F ? gap : typename Register<kLanes>::Floats{};
  sum_m2 += gap * gap;
}

/// Square gaps between the boxes [from, from + kLanes) of columns and the box from `low_m` to `high_m`, rounded down; a
/// point is a box without extent. [m^2]
template <std::uint32_t kLanes, typename Columns>
[[gnu::always_inline]] inline void square_gaps(const Columns& boxes, std::uint32_t from, const float* low_m,
                                               const float* high_m, typename Register<kLanes>::Floats& gaps_m2) {
  gaps_m2 = typename Register<kLanes>::Floats{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    typename Register<kLanes>::Floats low;
    typename Register<kLanes>::Floats high;
    std::memcpy(&low, boxes.low_m[axis].data() + from, sizeof(low));
    std::memcpy(&high, boxes.high_m[axis].data() + from, sizeof(high));
    add_square_gap<kLanes>(low - high_m[axis], low_m[axis] - high, gaps_m2);
  }
  gaps_m2 *= kRoundedDown;
}

}  // namespace kilter
