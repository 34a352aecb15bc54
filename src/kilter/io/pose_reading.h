// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "kilter/submap/robot_log.h"

namespace kilter {

/// Another way in which clouds and poses may belong together.
enum class PoseReading {
  kCloudsInWorld,  ///< clouds are in the world's frame already
  kInverse,        ///< poses are T_cloud_world
  kTransposed,     ///< positions are right, and rotations those of T_cloud_world
  kScalarFirst,    ///< quaternions were written qw first
  kOtherRobot,     ///< poses are those of another robot of the mission
  kShifted,        ///< each cloud belongs to the pose of a cloud that comes somewhat later or earlier
  kTurned,         ///< poses are the vehicle's, whose sensor is mounted turned
  kMirrored,       ///< axes are left-handed
  kOtherAxes,      ///< positions have other axes than rotations
  kNeither,        ///< none of these: poses are not of these clouds, or not of their sensor
};

/// How much better clouds meet if their poses are read otherwise.
struct OtherReading {
  PoseReading reading = PoseReading::kCloudsInWorld;
  double as_given = 0.0;   ///< share of points that meet the cloud of a pose one to three metres or half a radian away
  double otherwise = 0.0;  ///< under the reading; of kNeither, share that meets the next cloud, wherever that is
  std::string how;         ///< ends "clouds meet each other ..."; empty of kNeither
};

/// Looks at some clouds, a few metres of way or a turn between two of them, for a reading of the poses of the robot at
/// `place` under which they meet far better than as given, and at the next clouds to see how well they should.
/// A level robot cannot tell a mirror from a sensor on its head: then `how` names both.
/// \return  kNeither where none is clear and a quarter of what meets the next cloud meets those a few metres on as
/// given;
///          nothing where they meet as given, where the robot hardly moves or turns, or where clouds cannot be read.
/// Cost: reads up to three dozen clouds; where they meet badly, some 300 look-ups for 1,500 points of each of a dozen.
[[nodiscard]] std::optional<OtherReading> find_other_reading(std::span<const RobotLog> robots, std::size_t place);

}  // namespace kilter
