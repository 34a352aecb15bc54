// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

// What ROS's own library writes and reads. Its headers do not compile as C++20 (std::allocator<void>::rebind), so they
// stay in bag_by_ros.cc, which is C++17, and this header is both.
namespace kilter_testing {

enum class RosPacking { kNone, kBz2, kLz4 };

/// Where the base is at some time, and what its lidar sees then.
struct RosStep {
  std::uint32_t seconds = 0;
  std::uint32_t nanoseconds = 0;
  std::array<double, 3> position_m{};  ///< of the base in odom; its axes are odom's
  std::vector<std::array<float, 3>> points_m;
};

/// How the bag says where the base is: messages on /pose, or transforms.
enum class RosPoses { kOdometry, kPoseStamped, kPath, kTransforms };

/// A bag of /points, of poses as told, and of the lidar's place above the base in /tf_static, in several chunks.
/// kPoseStamped and kPath are of the lidar, since they name no frame that moves.
void write_bag_by_ros(const std::string& file, RosPacking packing, RosPoses poses, const std::vector<RosStep>& steps,
                      double lidar_above_base_m);

/// The bytes of all messages, in order of time.
std::vector<std::string> read_bag_by_ros(const std::string& file);

}  // namespace kilter_testing
