// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "kilter/simulation/slam.h"

namespace kilter {

/// A scan of a mission.
struct ScanRef {
  std::size_t robot = 0;
  std::size_t scan = 0;
  auto operator<=>(const ScanRef&) const = default;
};

/// Two scans taken at nearly the same place. `later` is a later scan of the same robot, or one of a later robot.
struct Meeting {
  ScanRef earlier;
  ScanRef later;
};

/// True distance of two scans. [m]
[[nodiscard]] double distance_m(std::span<const RobotMotion> truth, const ScanRef& a, const ScanRef& b);

/// The scan of `robot` in [first, last) that is nearest to `to`; the lower index wins. Absent when the range is empty.
[[nodiscard]] std::optional<ScanRef> nearest_scan(std::span<const RobotMotion> truth, const ScanRef& to,
                                                  std::size_t robot, std::size_t first, std::size_t last);

/// All places where a robot comes back to its own or another's path, spaced as the options say.
[[nodiscard]] std::vector<Meeting> find_meetings(std::span<const RobotMotion> truth, const SlamOptions& options);

}  // namespace kilter
