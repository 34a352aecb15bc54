// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/bag_by_ros.h"

#include <geometry_msgs/PoseStamped.h>
#include <nav_msgs/Odometry.h>
#include <nav_msgs/Path.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/PointCloud2.h>
#include <tf2_msgs/TFMessage.h>

#include <cstring>

namespace kilter_testing {
namespace {

constexpr unsigned kChunkBytes = 40'000;

ros::Time time_of(const RosStep& step) { return {step.seconds, step.nanoseconds}; }

sensor_msgs::PointCloud2 cloud_of(const RosStep& step) {
  sensor_msgs::PointCloud2 cloud;
  cloud.header.stamp = time_of(step);
  cloud.header.frame_id = "lidar";
  cloud.height = 1;
  cloud.width = static_cast<std::uint32_t>(step.points_m.size());
  for (unsigned axis = 0; axis < 3; ++axis) {
    sensor_msgs::PointField field;
    field.name = std::string(1, static_cast<char>('x' + axis));
    field.offset = 4 * axis;
    field.datatype = sensor_msgs::PointField::FLOAT32;
    field.count = 1;
    cloud.fields.push_back(field);
  }
  cloud.point_step = 16;  // four bytes of padding, as most drivers have
  cloud.row_step = cloud.point_step * cloud.width;
  cloud.data.resize(cloud.row_step);
  for (std::size_t i = 0; i < step.points_m.size(); ++i) {
    std::memcpy(&cloud.data[16 * i], step.points_m[i].data(), sizeof(step.points_m[i]));
  }
  return cloud;
}

geometry_msgs::PoseStamped pose_of(const RosStep& step, double above_m) {
  geometry_msgs::PoseStamped pose;
  pose.header.stamp = time_of(step);
  pose.header.frame_id = "odom";
  pose.pose.position.x = step.position_m[0];
  pose.pose.position.y = step.position_m[1];
  pose.pose.position.z = step.position_m[2] + above_m;
  pose.pose.orientation.w = 1.0;
  return pose;
}

nav_msgs::Odometry odometry_of(const RosStep& step) {
  const geometry_msgs::PoseStamped pose = pose_of(step, 0.0);
  nav_msgs::Odometry odometry;
  odometry.header = pose.header;
  odometry.child_frame_id = "base";
  odometry.pose.pose = pose.pose;
  return odometry;
}

tf2_msgs::TFMessage transform(const RosStep& step, const char* parent, const char* child,
                              const std::array<double, 3>& at_m) {
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = time_of(step);
  transform.header.frame_id = parent;
  transform.child_frame_id = child;
  transform.transform.translation.x = at_m[0];
  transform.transform.translation.y = at_m[1];
  transform.transform.translation.z = at_m[2];
  transform.transform.rotation.w = 1.0;
  tf2_msgs::TFMessage message;
  message.transforms.push_back(transform);
  return message;
}

rosbag::compression::CompressionType compression_of(RosPacking packing) {
  switch (packing) {
    case RosPacking::kNone:
      return rosbag::compression::Uncompressed;
    case RosPacking::kBz2:
      return rosbag::compression::BZ2;
    case RosPacking::kLz4:
      return rosbag::compression::LZ4;
  }
  return rosbag::compression::Uncompressed;
}

}  // namespace

void write_bag_by_ros(const std::string& file, RosPacking packing, RosPoses poses, const std::vector<RosStep>& steps,
                      double lidar_above_base_m) {
  rosbag::Bag bag(file, rosbag::bagmode::Write);
  bag.setCompression(compression_of(packing));
  bag.setChunkThreshold(kChunkBytes);
  bag.write("/tf_static", time_of(steps.front()),
            transform(steps.front(), "base", "lidar", {0, 0, lidar_above_base_m}));
  nav_msgs::Path path;
  for (const RosStep& step : steps) {
    const ros::Time time = time_of(step);
    path.header.stamp = time;
    path.header.frame_id = "odom";
    path.poses.push_back(pose_of(step, lidar_above_base_m));
    if (poses == RosPoses::kOdometry) bag.write("/pose", time, odometry_of(step));
    if (poses == RosPoses::kPoseStamped) bag.write("/pose", time, path.poses.back());
    if (poses == RosPoses::kPath) bag.write("/pose", time, path);
    if (poses == RosPoses::kTransforms) bag.write("/tf", time, transform(step, "odom", "base", step.position_m));
    bag.write("/points", time, cloud_of(step));
  }
}

std::vector<std::string> read_bag_by_ros(const std::string& file) {
  rosbag::Bag bag(file, rosbag::bagmode::Read);
  rosbag::View view(bag);
  std::vector<std::string> messages;
  for (const rosbag::MessageInstance& message : view) {
    std::string bytes(message.size(), '\0');
    ros::serialization::OStream stream(reinterpret_cast<std::uint8_t*>(bytes.data()), message.size());
    message.write(stream);
    messages.push_back(std::move(bytes));
  }
  return messages;
}

}  // namespace kilter_testing
