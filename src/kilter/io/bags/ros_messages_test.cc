// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/ros_messages.h"

#include <gtest/gtest.h>

#include <cmath>

#include "testing/allocation_watch.h"
#include "testing/ros_bytes.h"

namespace kilter {
namespace {

using kilter_testing::at_x;
using kilter_testing::largest_allocation;
using kilter_testing::RosDialect;

constexpr RosDialect kDialects[] = {RosDialect::kRos1, RosDialect::kCdrLittle, RosDialect::kCdrBig};

MessageEncoding encoding_of(RosDialect dialect) {
  return dialect == RosDialect::kRos1 ? MessageEncoding::kRos1 : MessageEncoding::kCdr;
}

TEST(RosType, IsKnownByItsNamesInBothSystems) {
  EXPECT_EQ(ros_type_of("nav_msgs/Odometry"), RosType::kOdometry);
  EXPECT_EQ(ros_type_of("nav_msgs/msg/Odometry"), RosType::kOdometry);
  EXPECT_EQ(ros_type_of("tf/tfMessage"), RosType::kTransforms);
  EXPECT_EQ(ros_type_of("sensor_msgs/msg/Image"), RosType::kOther);
  EXPECT_EQ(ros_type_of(std::string(100000, '/')), RosType::kOther);
}

TEST(RosMessages, GiveBackAnOdometryInEveryDialect) {
  for (const RosDialect dialect : kDialects) {
    // Names of other lengths move what follows to other alignments.
    for (const std::string child : {"", "b", "ba", "bas", "base", "base_"}) {
      const std::string bytes = kilter_testing::odometry_message(dialect, 1'500'000'001'000'000'002, "/odom", child,
                                                                 {1, 2, 3, 0.6, 0, 0, 0.8});
      const auto pose = read_ros_pose(bytes, RosType::kOdometry, encoding_of(dialect), "f");
      ASSERT_TRUE(pose) << to_string(pose.error());
      EXPECT_EQ(pose->header.stamp_ns, 1'500'000'001'000'000'002);
      EXPECT_EQ(pose->header.frame, "odom");
      EXPECT_EQ(pose->child_frame, child);
      EXPECT_EQ(pose->T_frame_child.translation_m(), Eigen::Vector3d(1, 2, 3));
      EXPECT_NEAR(pose->T_frame_child.rotation().x(), 0.6, 1e-15);
    }
  }
}

TEST(RosMessages, GiveBackPathsAndTransforms) {
  for (const RosDialect dialect : kDialects) {
    const auto path = read_ros_poses(kilter_testing::path_message(dialect, "map", {{5, at_x(1)}, {6, at_x(2)}}),
                                     RosType::kPath, encoding_of(dialect), "f");
    ASSERT_TRUE(path);
    ASSERT_EQ(path->poses.size(), 2U);
    EXPECT_EQ(path->poses[1].header.stamp_ns, 6);
    EXPECT_EQ(path->poses[1].header.frame, "map");
    EXPECT_EQ(path->poses[1].T_frame_child.translation_m().x(), 2.0);
    const auto transforms =
        read_ros_poses(kilter_testing::transforms_message(
                           dialect, {{7, "map", "odom", at_x(3)}, {8, "odom", "base", {1, 1, 1, 0, 0, 0, 0}}}),
                       RosType::kTransforms, encoding_of(dialect), "f");
    ASSERT_TRUE(transforms);
    ASSERT_EQ(transforms->poses.size(), 1U);
    EXPECT_EQ(transforms->poses[0].child_frame, "odom");
    EXPECT_EQ(transforms->invalid, 1U);
  }
}

TEST(RosMessages, RefusePosesThatAreNone) {
  const double nan = std::nan("");
  for (const std::array<double, 7> pose : {std::array<double, 7>{nan, 0, 0, 0, 0, 0, 1},
                                           {1e9, 0, 0, 0, 0, 0, 1},
                                           {0, 0, 0, 0, 0, 0, 0},
                                           {0, 0, 0, 0, nan, 0, 1},
                                           {0, 0, 0, 1, 1, 1, 1}}) {
    const auto refused = read_ros_pose(kilter_testing::pose_message(RosDialect::kRos1, 1, "map", pose),
                                       RosType::kPoseStamped, MessageEncoding::kRos1, "f");
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kInvalidPose);
  }
}

TEST(RosMessages, RefuseEveryMessageCutShort) {
  for (const RosDialect dialect : kDialects) {
    const std::string pose = kilter_testing::pose_message(dialect, 1, "map", at_x(1));
    for (std::size_t length = 0; length < pose.size(); ++length) {
      const auto cut = read_ros_pose(pose.substr(0, length), RosType::kPoseStamped, encoding_of(dialect), "f");
      ASSERT_FALSE(cut);
      EXPECT_EQ(cut.error().code, ErrorCode::kTruncated);
    }
    const std::string path = kilter_testing::path_message(dialect, "map", {{5, at_x(1)}, {6, at_x(2)}});
    for (std::size_t length = 0; length < path.size(); ++length) {
      EXPECT_FALSE(read_ros_poses(path.substr(0, length), RosType::kPath, encoding_of(dialect), "f"));
    }
  }
}

TEST(RosMessages, AllocateNothingForCountsOfBillions) {
  std::string bomb = kilter_testing::path_message(RosDialect::kRos1, "map", {});
  bomb.replace(bomb.size() - 4, 4, "\xFF\xFF\xFF\xFF");
  largest_allocation() = 0;
  EXPECT_FALSE(read_ros_poses(bomb, RosType::kPath, MessageEncoding::kRos1, "f"));
  EXPECT_LE(largest_allocation(), 1024U);
}

TEST(RosMessages, RefuseOtherEncapsulations) {
  std::string bytes = kilter_testing::pose_message(RosDialect::kCdrLittle, 1, "map", at_x(1));
  bytes[1] = 7;  // XCDR2
  const auto refused = read_ros_pose(bytes, RosType::kPoseStamped, MessageEncoding::kCdr, "f");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kUnsupported);
}

}  // namespace
}  // namespace kilter
