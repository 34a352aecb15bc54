// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string_view>

namespace kilter {

/// How a message's fields lie in its bytes.
enum class MessageEncoding {
  kRos1,   ///< packed, little endian
  kCdr,    ///< aligned, behind four bytes that say the byte order (ROS 2)
  kOther,  ///< nothing that kilter reads
};

/// The messages that kilter reads.
enum class RosType { kOther, kPointCloud2, kOdometry, kPoseStamped, kPoseWithCovarianceStamped, kPath, kTransforms };

/// The type by its name in ROS 1 ("nav_msgs/Path", "tf/tfMessage") or ROS 2 ("nav_msgs/msg/Path").
[[nodiscard]] RosType ros_type_of(std::string_view name);

/// "nav_msgs/Path".
[[nodiscard]] std::string_view name_of(RosType type);

/// How much of a message the walk has to see: nothing, what stands in front (4 kB), or all.
[[nodiscard]] std::uint64_t bytes_wanted(RosType type);

}  // namespace kilter
