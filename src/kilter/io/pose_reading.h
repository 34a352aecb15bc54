// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "kilter/submap/robot_log.h"

namespace kilter {

/// Another way in which clouds and poses may belong together.
enum class PoseReading {
  kCloudsInWorld,  ///< clouds are in the world's frame already
  kInverse,        ///< poses are T_cloud_world
  kNeither,        ///< none of these: poses are not of these clouds, or not of their sensor
};

/// How much better clouds meet if their poses are read otherwise.
struct OtherReading {
  PoseReading reading = PoseReading::kCloudsInWorld;
  double as_given = 0.0;   ///< share of points that meet the cloud of a pose one to three metres away
  double otherwise = 0.0;  ///< under the reading; of kNeither, share that meets the next cloud, wherever that is
};

/// Looks at some clouds, a few metres of way between two of them, for a reading under which they meet far better than
/// as given, and at the next clouds to see how well they should. \return  kNeither where they hardly meet under any;
/// nothing where they meet as given, where the robot hardly moves, or where clouds cannot be read.
[[nodiscard]] std::optional<OtherReading> find_other_reading(const RobotLog& robot);

}  // namespace kilter
