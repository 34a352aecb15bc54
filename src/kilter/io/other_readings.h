// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kilter/io/pose_reading.h"
#include "kilter/submap/robot_log.h"

namespace kilter {

/// One way to read a robot's poses.
struct Reading {
  PoseReading kind = PoseReading::kInverse;
  std::string how;  ///< ends a sentence such as "clouds meet each other ..."
  /// T_world_cloud of a cloud, up to a rotation that is the same for all; nothing where the reading has none.
  std::function<std::optional<Pose3>(std::size_t)> pose_of;
  Eigen::Matrix3d R_body_sensor = Eigen::Matrix3d::Identity();  ///< of kTurned
};

/// Poses as they are, had their sensor been mounted with its axes as the columns of `axes`, or seen its world in a
/// mirror if these are left-handed.
[[nodiscard]] Pose3 with_axes(const Pose3& T, const Eigen::Matrix3d& axes);

/// Poses of a robot whose sensor is mounted turned by a rotation matrix.
[[nodiscard]] Reading turned_reading(const RobotLog& robot, const Eigen::Matrix3d& R_body_sensor);

/// What is known to go wrong between a trajectory and its file, for the robot at `place`; the plainest come first.
/// The robots must outlive what is returned.
[[nodiscard]] std::vector<Reading> other_readings(std::span<const RobotLog> robots, std::size_t place);

}  // namespace kilter
