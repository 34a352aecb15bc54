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

/// A robot whose poses and clouds are those of an earlier one, so that the two agree perfectly and prove nothing: pairs
/// of their numbers, the later one first. Poses are compared, and two clouds of each at their first bytes.
[[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> robots_given_twice(std::span<const RobotLog> robots);

}  // namespace kilter
