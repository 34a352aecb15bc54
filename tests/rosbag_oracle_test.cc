// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Our ROS 1 bags against those of ROS's own library, both ways. Built with KILTER_ORACLES only.
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/PointCloud2.h>
#include <tf2_msgs/TFMessage.h>

#include <cstring>
#include <string>
#include <vector>

#include "kilter/io/bags/rosbag1.h"
#include "kilter/io/mission.h"
#include "testing/bag_walk.h"
#include "testing/temp_folder.h"

namespace kilter {
namespace {

constexpr int kClouds = 7;
constexpr int kPoints = 2000;

ros::Time time_of(int i) { return {1'700'000'000U + static_cast<unsigned>(i), 250'000'000U}; }

float coordinate(int cloud, int point, int axis) {
  return static_cast<float>(cloud) + 0.01F * static_cast<float>(point) + 100.0F * static_cast<float>(axis);
}

sensor_msgs::PointCloud2 cloud_of(int i) {
  sensor_msgs::PointCloud2 cloud;
  cloud.header.stamp = time_of(i);
  cloud.header.frame_id = "lidar";
  cloud.height = 1;
  cloud.width = kPoints;
  for (unsigned axis = 0; axis < 3; ++axis) {
    sensor_msgs::PointField field;
    field.name = std::string(1, static_cast<char>('x' + axis));
    field.offset = 4 * axis;
    field.datatype = sensor_msgs::PointField::FLOAT32;
    field.count = 1;
    cloud.fields.push_back(field);
  }
  cloud.point_step = 16;
  cloud.row_step = cloud.point_step * cloud.width;
  cloud.data.resize(cloud.row_step);
  for (int point = 0; point < kPoints; ++point) {
    for (int axis = 0; axis < 3; ++axis) {
      const float value = coordinate(i, point, axis);
      std::memcpy(&cloud.data[static_cast<std::size_t>(16 * point + 4 * axis)], &value, sizeof(value));
    }
  }
  return cloud;
}

nav_msgs::Odometry odometry_of(int i) {
  nav_msgs::Odometry odometry;
  odometry.header.stamp = time_of(i);
  odometry.header.frame_id = "odom";
  odometry.child_frame_id = "base";
  odometry.pose.pose.position.x = 0.5 * i;
  odometry.pose.pose.orientation.w = 1.0;
  return odometry;
}

// The lidar a metre above the base.
tf2_msgs::TFMessage mount() {
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = time_of(0);
  transform.header.frame_id = "base";
  transform.child_frame_id = "lidar";
  transform.transform.translation.z = 1.0;
  transform.transform.rotation.w = 1.0;
  tf2_msgs::TFMessage message;
  message.transforms.push_back(transform);
  return message;
}

TEST(RosbagOracle, ReadsWhatRosWrites) {
  for (const auto packing : {rosbag::compression::Uncompressed, rosbag::compression::BZ2, rosbag::compression::LZ4}) {
    SCOPED_TRACE(packing);
    const kilter_testing::TempFolder folder;
    const auto file = folder.path() / "run.bag";
    {
      rosbag::Bag bag(file.string(), rosbag::bagmode::Write);
      bag.setCompression(packing);
      bag.setChunkThreshold(40'000);  // several chunks
      bag.write("/tf_static", time_of(0), mount());
      for (int i = 0; i < kClouds; ++i) {
        bag.write("/odom", time_of(i), odometry_of(i));
        bag.write("/points", time_of(i), cloud_of(i));
      }
    }
    const auto mission = open_mission({file.string()});
    ASSERT_TRUE(mission) << to_string(mission.error());
    const RobotLog& log = mission->robots.front();
    ASSERT_EQ(log.T_world_cloud.size(), static_cast<std::size_t>(kClouds));
    for (int i = 0; i < kClouds; ++i) {
      const auto index = static_cast<std::size_t>(i);
      EXPECT_EQ(log.T_world_cloud[index].translation_m(), Eigen::Vector3d(0.5 * i, 0.0, 1.0));
      EXPECT_EQ(log.stamps_ns[index], static_cast<std::int64_t>(time_of(i).toNSec()));
      const auto cloud = log.read_cloud(index);
      ASSERT_TRUE(cloud) << to_string(cloud.error());
      ASSERT_EQ(cloud->points_m.size(), static_cast<std::size_t>(kPoints));
      for (int point = 0; point < kPoints; ++point) {
        const Eigen::Vector3f expected(coordinate(i, point, 0), coordinate(i, point, 1), coordinate(i, point, 2));
        ASSERT_EQ(cloud->points_m[static_cast<std::size_t>(point)], expected);
      }
    }
  }
}

TEST(RosbagOracle, RosReadsTheFixturesThatOurTestsRestOn) {
  const auto messages = kilter_testing::small_drive(kilter_testing::RosDialect::kRos1);
  for (const auto packing : {kilter_testing::BagPacking::kNone, kilter_testing::BagPacking::kBz2}) {
    const kilter_testing::TempFolder folder;
    const auto file = folder.write("run.bag", kilter_testing::rosbag1_bytes(messages, {.packing = packing}));
    rosbag::Bag bag(file.string(), rosbag::bagmode::Read);
    rosbag::View view(bag);
    ASSERT_EQ(view.size(), messages.size());
    std::vector<std::string> theirs;
    for (const rosbag::MessageInstance& message : view) {
      std::string bytes(message.size(), '\0');
      ros::serialization::OStream stream(reinterpret_cast<std::uint8_t*>(bytes.data()), message.size());
      message.write(stream);
      theirs.push_back(bytes);
    }
    std::vector<std::string> ours;
    for (const auto& message : messages) ours.push_back(message.bytes);
    std::sort(theirs.begin(), theirs.end());
    std::sort(ours.begin(), ours.end());
    EXPECT_EQ(theirs, ours);
  }
}

}  // namespace
}  // namespace kilter
