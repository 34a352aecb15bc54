// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/geometry/pose3.h"
#include "kilter/io/bags/message_cursor.h"
#include "kilter/io/bags/ros_type.h"

namespace kilter {

/// What stands in front of most messages.
struct RosHeader {
  std::int64_t stamp_ns = 0;
  std::string frame;  ///< without the slash that ROS 1 put in front
};

/// A pose as a message gives it, checked: T_frame_child.
struct RosPose {
  RosHeader header;
  std::string child_frame;  ///< empty where the message's type has none
  Pose3 T_frame_child;
};

/// What a sensor_msgs/PointCloud2 begins with.
struct CloudHead {
  RosHeader header;
  std::uint64_t points = 0;  ///< height times width; nobody has looked whether they are there
};

/// Reads a PointCloud2's beginning alone.
///
/// Each of these takes a message as it lies in a bag, or as much of it as they need.
/// \return  kTruncated (it ends inside a field), kUnsupported (not plain CDR); nothing is allocated that the bytes do
///          not justify.
[[nodiscard]] Expected<CloudHead> read_cloud_head(std::string_view bytes, MessageEncoding encoding,
                                                  const std::string& where);

/// Reads one message with one pose: kOdometry, kPoseStamped or kPoseWithCovarianceStamped.
/// \return  besides, kInvalidPose: not finite, farther than kMaxPosition_m, or a quaternion more than 1 % off unit
/// length.
[[nodiscard]] Expected<RosPose> read_ros_pose(std::string_view bytes, RosType type, MessageEncoding encoding,
                                              const std::string& where);

/// A message with several, and how many of them were no poses.
struct RosPoses {
  std::vector<RosPose> poses;
  std::size_t invalid = 0;
};

/// Reads kPath or kTransforms. A path's poses carry their own stamps, and the path's frame.
[[nodiscard]] Expected<RosPoses> read_ros_poses(std::string_view bytes, RosType type, MessageEncoding encoding,
                                                const std::string& where);

/// Takes a header off a message.
[[nodiscard]] RosHeader take_header(MessageCursor& cursor);

}  // namespace kilter
