// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>

namespace kilter {

/// Whether people are told a turn (a rotation vector along the world's axes) as one to the left or right: its axis lies
/// no farther than 30 degrees from the vertical. No turn at all is neither.
[[nodiscard]] inline bool is_mostly_upright(const Eigen::Vector3d& turn_world) {
  constexpr double kLeast = std::numbers::sqrt3 / 2.0;
  return turn_world.z() != 0.0 && std::abs(turn_world.z()) >= kLeast * turn_world.norm();
}

}  // namespace kilter
