// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "kilter/io/inspection.h"
#include "kilter/io/oddity.h"
#include "kilter/submap/robot_log.h"

namespace kilter {

/// What is odd about robots, in their order. \pre both spans are of the same robots
[[nodiscard]] std::vector<Oddity> find_oddities(std::span<const RobotLog> robots,
                                                std::span<const RobotInspection> seen);

/// A robot whose clouds are those of an earlier one. Where the places are, too, the two agree perfectly and prove
/// nothing; otherwise they tell how two estimates of one path differ.
struct GivenTwice {
  std::size_t later = 0;
  std::size_t earlier = 0;
  bool same_places = true;
};

/// Three clouds of each are compared at their first bytes.
[[nodiscard]] std::vector<GivenTwice> robots_given_twice(std::span<const RobotLog> robots);

}  // namespace kilter
