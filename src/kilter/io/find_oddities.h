// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "kilter/io/inspection.h"
#include "kilter/io/oddity.h"
#include "kilter/submap/robot_log.h"

namespace kilter {

/// What is odd about robots, in their order. \pre both spans are of the same robots
[[nodiscard]] std::vector<Oddity> find_oddities(std::span<const RobotLog> robots,
                                                std::span<const RobotInspection> seen);

}  // namespace kilter
