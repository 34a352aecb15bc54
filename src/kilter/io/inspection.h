// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/io/mission.h"
#include "kilter/io/oddity.h"
#include "kilter/submap/build_submaps.h"

namespace kilter {

/// How many points a robot's clouds hold; of octrees, how many voxels of their own size they know to be occupied.
struct PointCount {
  std::uint64_t points = 0;
  bool estimated = false;  ///< from some of the clouds
};

/// What can be told of a robot from its poses, its clouds' headers and its first cloud.
struct RobotInspection {
  std::string name;
  std::string kind;  ///< of its source
  bool finished_submaps = false;
  std::size_t clouds = 0;  ///< that have a pose
  std::size_t clouds_found = 0;
  std::size_t poses_found = 0;
  bool poses_are_a_trajectory = false;  ///< as in RobotLog
  std::size_t clouds_unread = 0;        ///< beyond what a glance took in: all but `points` leaves them out
  std::optional<PointCount> points;     ///< absent where headers do not tell
  bool points_are_voxels = false;       ///< of octrees
  double path_length_m = 0.0;
  Eigen::AlignedBox3d extent_world_m;    ///< of the poses
  std::optional<std::int64_t> first_ns;  ///< earliest stamp, where there are stamps
  std::optional<std::int64_t> last_ns;   ///< and the latest
  std::string stamp_unit;                ///< in which they were written, known or guessed: "s"; else empty
  std::size_t likely_submaps = 0;        ///< as `check` would cut them
  std::size_t first_points = 0;          ///< of the first cloud, once read
  std::size_t first_dropped = 0;         ///< and how many of it were not finite or too far
  std::optional<double> median_range_m;  ///< of the first cloud's points from its origin; absent without points
  /// How far all but a twentieth of the first cloud lies from its origin, of a scan within the range limits; of an
  /// octree what it knows to be occupied. Absent without points. [m]
  std::optional<double> reach_m;
};

/// What a mission holds, and what is odd about it.
struct Inspection {
  std::vector<RobotInspection> robots;
  std::size_t likely_submaps = 0;
  /// Pairs of submaps, neighbours along a path included, whose routes come within reach of each other: what both reach
  /// together. What stands in between is not known, so that `check` may find fewer. Absent where there are too many
  /// submaps to count them at once.
  std::optional<std::size_t> likely_pairs;
  std::vector<Oddity> oddities;  ///< robot by robot
};

/// Looks at a mission without building anything: headers of all clouds (of some thousand at most), the first cloud of
/// each robot, octrees of five million leaves together, as many clouds as it takes to tell whether neighbours are the
/// same, and up to three dozen to tell whether they meet as the poses say (find_other_reading).
/// \return  or what reading a first cloud or octree fails with, or check_usable for a robot.
[[nodiscard]] Expected<Inspection> inspect(const Mission& mission, const SubmapOptions& options);

}  // namespace kilter
