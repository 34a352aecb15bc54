// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <numbers>
#include <span>
#include <vector>

#include "kilter/base/option_table.h"
#include "kilter/geometry/pose3.h"
#include "kilter/submap/robot_log.h"

namespace kilter {

/// When a new submap begins (Sec. III-A: after a certain distance or rotation).
struct CuttingOptions {
  double submap_distance_m = 10.0;  ///< path length that ends a submap. [m]
  /// Accumulated turning that ends a submap. Half a turn: ordinary corners never cut (the seed counts eight 10 m
  /// submaps round a building, so its corners did not either), a turn on the spot or a U-turn does, because odometry
  /// slips there and a submap should not hold both sides of a slip. [rad]
  double submap_rotation_rad = std::numbers::pi;
  int min_scans = 1;  ///< a submap is not ended before it holds this many scans
};

[[nodiscard]] std::vector<OptionField> fields(CuttingOptions& options);

/// Cuts a robot's journey: a scan that lies submap_distance of path, or submap_rotation of summed turning, from the
/// first scan of its submap begins the next. A last piece shorter than a third of that joins its predecessor.
/// \return ranges without gaps over all poses; empty for no poses. O(n).
[[nodiscard]] std::vector<ScanRange> cut_trajectory(std::span<const Pose3> T_world_scan,
                                                    const CuttingOptions& options = {});

/// Length of the path through the poses up to each of them; same size, first 0. [m]
[[nodiscard]] std::vector<double> path_lengths_m(std::span<const Pose3> T_world_scan);

}  // namespace kilter
