// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/frame_tree.h"

#include <gtest/gtest.h>

namespace kilter {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

RosPose transform(std::int64_t stamp_ns, std::string parent, std::string child, const Pose3& T_parent_child) {
  return {{stamp_ns, std::move(parent)}, std::move(child), T_parent_child};
}

Pose3 turned(double x, double yaw) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())), {x, 0, 0}};
}

// map -> odom (seldom) -> base (often) -> lidar (static).
FrameTree robot(const std::string& prefix = "") {
  FrameTree tree;
  for (int i = 0; i <= 4; ++i) {
    tree.add(transform(kSecond * i / 10, prefix + "odom", prefix + "base", turned(i, 0)), false);
  }
  tree.add(transform(0, "earth", prefix + "map", Pose3::from_translation(1000, 0, 0)), true);
  tree.add(transform(0, prefix + "map", prefix + "odom", turned(10, 1.5707963267948966)), false);
  tree.add(transform(0, prefix + "base", prefix + "lidar", Pose3::from_translation(0.5, 0, 2)), true);
  tree.finish();
  return tree;
}

TEST(FrameTree, ComposesTransformsFromTheMapDown) {
  for (const std::string prefix : {"", "a/"}) {
    const FrameTree tree = robot(prefix);
    const auto chain = tree.chain_from(prefix + "lidar");
    ASSERT_TRUE(chain);
    EXPECT_EQ(chain->fixed_frame, prefix + "map");
    EXPECT_EQ(chain->samples, 5U);
    // Half way between base at 2 and at 3: 2.5 + 0.5 along odom's x, which is the map's y.
    const auto T_map_lidar = tree.at(*chain, kSecond / 4, kSecond / 2, 0);
    ASSERT_TRUE(T_map_lidar);
    EXPECT_TRUE(T_map_lidar->translation_m().isApprox(Eigen::Vector3d(10, 3.0, 2), 1e-12));
  }
}

TEST(FrameTree, HoldsCorrectionsOfDriftForSomeTimeOnly) {
  const FrameTree tree = robot();
  const auto chain = tree.chain_from("lidar");
  EXPECT_TRUE(tree.at(*chain, kSecond * 4 / 10, kSecond / 2, 0));
  EXPECT_FALSE(tree.at(*chain, kSecond * 5 / 10, kSecond / 2, kSecond / 50));
  // Of the base there is a pose 11.6 s before, of odom one 12 s before.
  EXPECT_FALSE(tree.at(*chain, 12 * kSecond, kSecond / 2, kSecond * 117 / 10));
  EXPECT_TRUE(tree.at(*chain, 12 * kSecond, kSecond / 2, kSecond * 121 / 10));
}

TEST(FrameTree, WhatIsSentOverAndOverTheSameIsAsGoodAsStatic) {
  FrameTree tree;
  for (int i = 0; i <= 4; ++i) {
    tree.add(transform(kSecond * i / 10, "odom", "base", turned(i, 0)), false);
    tree.add(transform(kSecond * i / 10, "base", "lidar", Pose3::from_translation(0.5, 0, 2)), false);
    tree.add(transform(kSecond * i / 10, "base", "arm", Pose3::from_translation(0, 0, i == 4 ? 1.01 : 1.0)), false);
  }
  tree.add(transform(0, "base", "once", Pose3()), false);
  tree.finish();
  const auto T_base_lidar = tree.static_between("base", "lidar");
  ASSERT_TRUE(T_base_lidar);
  EXPECT_TRUE(T_base_lidar->translation_m().isApprox(Eigen::Vector3d(0.5, 0, 2), 1e-12));
  EXPECT_FALSE(tree.static_between("base", "arm"));
  EXPECT_FALSE(tree.static_between("base", "once"));
  EXPECT_FALSE(tree.static_between("odom", "base"));
  EXPECT_EQ(tree.chain_from("lidar")->fixed_frame, "odom");
}

TEST(FrameTree, HoldsWhatNeverChangesAtAnyTimeHoweverSeldomItWasSent) {
  FrameTree tree;
  for (int i = 0; i < 21; ++i) {
    tree.add(transform(kSecond * i / 10, "odom", "base", Pose3::from_translation(i, 0, 0)), false);
    if (i % 10 == 5) tree.add(transform(kSecond * i / 10, "base", "lidar", Pose3::from_translation(0, 0, 2)), false);
  }
  tree.finish();
  const auto chain = tree.chain_from("lidar");
  ASSERT_TRUE(chain);
  EXPECT_EQ(chain->samples, 21U);
  EXPECT_EQ(chain->first_ns, 0);
  EXPECT_EQ(chain->last_ns, 2 * kSecond);
  const auto T_odom_lidar = tree.at(*chain, kSecond, kSecond / 4, 0);
  ASSERT_TRUE(T_odom_lidar);
  EXPECT_TRUE(T_odom_lidar->translation_m().isApprox(Eigen::Vector3d(10, 0, 2), 1e-12));
}

TEST(FrameTree, WhatStandsStillAltogetherHoldsAsLongAsItWasSent) {
  FrameTree tree;
  for (int i = 0; i < 2; ++i) tree.add(transform(kSecond * i, "odom", "base", Pose3()), false);
  tree.finish();
  const auto chain = tree.chain_from("base");
  ASSERT_TRUE(chain);
  EXPECT_TRUE(tree.at(*chain, kSecond, kSecond, 0));
  EXPECT_FALSE(tree.at(*chain, 5 * kSecond, kSecond, 0));
}

TEST(FrameTree, KnowsNoWayWhereNothingMoves) {
  FrameTree tree;
  tree.add(transform(0, "base", "lidar", Pose3()), true);
  tree.finish();
  EXPECT_FALSE(tree.chain_from("lidar"));
  EXPECT_FALSE(tree.chain_from("elsewhere"));
}

TEST(FrameTree, TakesTheRootWhereNoFrameIsCalledAsUsual) {
  FrameTree tree;
  tree.add(transform(0, "camera_init", "body", Pose3()), false);
  tree.finish();
  EXPECT_EQ(tree.chain_from("body")->fixed_frame, "camera_init");
}

TEST(FrameTree, EndsInLoopsAndEndlessChains) {
  FrameTree tree;
  tree.add(transform(0, "a", "b", Pose3()), false);
  tree.add(transform(0, "b", "a", Pose3()), false);
  tree.add(transform(0, "s", "t", Pose3()), true);
  tree.add(transform(0, "t", "s", Pose3()), true);
  for (int i = 0; i < 1000; ++i) tree.add(transform(0, std::to_string(i + 1), std::to_string(i), Pose3()), false);
  tree.finish();
  EXPECT_TRUE(tree.chain_from("a"));
  EXPECT_LE(tree.chain_from("0")->edges.size(), FrameTree::kMaxChain);
  EXPECT_FALSE(tree.static_between("s", "elsewhere"));
}

TEST(FrameTree, FindsStaticWaysUpAndDown) {
  FrameTree tree;
  tree.add(transform(0, "base", "imu", Pose3::from_translation(1, 0, 0)), true);
  tree.add(transform(0, "base", "mount", Pose3::from_translation(0, 1, 0)), true);
  tree.add(transform(0, "mount", "lidar", Pose3::from_translation(9, 9, 9)), true);
  tree.add(transform(1, "mount", "lidar", Pose3::from_translation(0, 0, 1)), true);  // sent again, corrected
  tree.finish();
  EXPECT_TRUE(tree.static_between("imu", "lidar")->translation_m().isApprox(Eigen::Vector3d(-1, 1, 1), 1e-15));
  EXPECT_TRUE(tree.static_between("lidar", "base")->translation_m().isApprox(Eigen::Vector3d(0, -1, -1), 1e-15));
  EXPECT_TRUE(tree.static_between("any", "any"));
  EXPECT_FALSE(tree.static_between("imu", "camera"));
}

}  // namespace
}  // namespace kilter
