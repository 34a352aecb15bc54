// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/ros_type.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

namespace kilter {
namespace {

constexpr std::array<std::pair<std::string_view, RosType>, 7> kTypes = {{
    {"sensor_msgs/PointCloud2", RosType::kPointCloud2},
    {"nav_msgs/Odometry", RosType::kOdometry},
    {"geometry_msgs/PoseStamped", RosType::kPoseStamped},
    {"geometry_msgs/PoseWithCovarianceStamped", RosType::kPoseWithCovarianceStamped},
    {"nav_msgs/Path", RosType::kPath},
    {"tf2_msgs/TFMessage", RosType::kTransforms},
    {"tf/tfMessage", RosType::kTransforms},  // its name in the first years
}};

}  // namespace

RosType ros_type_of(std::string_view name) {
  std::string short_name(name.substr(0, 200));
  if (const std::size_t msg = short_name.find("/msg/"); msg != std::string::npos) short_name.erase(msg, 4);
  const auto found =
      std::find_if(kTypes.begin(), kTypes.end(), [&](const auto& row) { return row.first == short_name; });
  return found == kTypes.end() ? RosType::kOther : found->second;
}

std::string_view name_of(RosType type) {
  const auto found = std::find_if(kTypes.begin(), kTypes.end(), [&](const auto& row) { return row.second == type; });
  return found == kTypes.end() ? "another type" : found->first;
}

std::uint64_t bytes_wanted(RosType type) {
  // Names of frames are the only thing of free length in front of a stamp or a pose.
  constexpr std::uint64_t kHead = 4096;
  switch (type) {
    case RosType::kOther:
      return 0;
    case RosType::kTransforms:
      return UINT64_MAX;
    case RosType::kPointCloud2:
    case RosType::kOdometry:
    case RosType::kPoseStamped:
    case RosType::kPoseWithCovarianceStamped:
    case RosType::kPath:  // only the last one is read
      return kHead;
  }
  return 0;
}

}  // namespace kilter
