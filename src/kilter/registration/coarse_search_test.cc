// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/coarse_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <tuple>
#include <vector>

#include "kilter/occupancy/map_builder.h"
#include "testing/allocation_watch.h"
#include "testing/scenes.h"

namespace kilter {
namespace {

using testing::pose_at;
using testing::room_pair;
using testing::SubmapPair;

TEST(CoarseSearch, OneOfTheBestPosesLiesInTheBasinOfTheTruth) {
  const SubmapPair views = room_pair();
  for (const auto& [x, y, yaw] :
       {std::tuple(0.0, 0.0, 0.0), std::tuple(2.3, -1.7, 0.15), std::tuple(-3.6, 3.1, -0.3)}) {
    const Pose3 start = pose_at(x, y, 0.0, yaw) * views.T_target_source;
    const auto poses =
        coarse_search(views.source.map, views.target.map, start, {5.0, 0.5, 0.35}, Eigen::Vector3d::UnitZ(), 6);
    ASSERT_FALSE(poses.empty());
    double nearest_m = 99.0;
    for (const CoarsePose& pose : poses) {
      const Pose3 error = views.T_target_source.inverse() * pose.T_target_source;
      if (error.angle_rad() < 0.1) nearest_m = std::min(nearest_m, error.translation_m().norm());
      EXPECT_LE(pose.score, poses.front().score);
      EXPECT_LE(pose.score, 1.0);
    }
    EXPECT_LT(nearest_m, 0.6) << x;
  }
}

// What both saw may lie far from the source's middle: an error about it moves the middle by more than it is itself.
TEST(CoarseSearch, AnErrorMayTurnAboutAFarPlace) {
  const SubmapPair views = room_pair();
  const Pose3 about = pose_at(-1.5, -2.0, 0.0, 0.0);  // of the target's frame, at the far side of the room
  const Pose3 off = about * pose_at(0.5, -0.5, 0.0, 0.5) * about.inverse();
  const auto poses = coarse_search(views.source.map, views.target.map, off * views.T_target_source, {0.8, 0.5, 0.55},
                                   Eigen::Vector3d::UnitZ(), 6);
  double nearest_m = 99.0;
  for (const CoarsePose& pose : poses) {
    const Pose3 error = views.T_target_source.inverse() * pose.T_target_source;
    if (error.angle_rad() < 0.1) nearest_m = std::min(nearest_m, error.translation_m().norm());
  }
  EXPECT_LT(nearest_m, 0.6);
}

// Six starts in one basin would leave the next aisle unseen.
TEST(CoarseSearch, NoTwoPosesLieInOneBasin) {
  const SubmapPair views = room_pair();
  const auto poses = coarse_search(views.source.map, views.target.map, views.T_target_source, {5.0, 0.5, 0.35},
                                   Eigen::Vector3d::UnitZ(), 10);
  ASSERT_EQ(poses.size(), 10U);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Pose3 apart = poses[i].T_target_source.inverse() * poses[j].T_target_source;
      EXPECT_TRUE(apart.translation_m().norm() > 0.6 || apart.angle_rad() > 0.1) << i << " " << j;
    }
  }
}

// Turns to either side meet behind: what lies there is one pose, and one start.
TEST(CoarseSearch, AWholeTurnFindsWhatLiesBehindOnce) {
  const SubmapPair views = room_pair();
  const Pose3 start = views.T_target_source * pose_at(0.0, 0.0, 0.0, 3.1);
  const auto poses = coarse_search(views.source.map, views.target.map, start, {1.0, 0.5, std::numbers::pi},
                                   Eigen::Vector3d::UnitZ(), 6);
  ASSERT_GE(poses.size(), 2U);
  EXPECT_LT((views.T_target_source.inverse() * poses[0].T_target_source).angle_rad(), 0.1);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Pose3 apart = poses[0].T_target_source.inverse() * poses[i].T_target_source;
    EXPECT_TRUE(apart.translation_m().norm() > 0.6 || apart.angle_rad() > 0.1) << i;
  }
}

TEST(CoarseSearch, TheVerticalMayLieAnywhereInTheTarget) {
  const SubmapPair views = room_pair();
  // The same pair with the target's frame lying on its side.
  const Pose3 T_side_target(Eigen::Quaterniond(Eigen::AngleAxisd(1.5707963, Eigen::Vector3d::UnitX())), {0, 0, 0});
  Submap lying = views.target;
  MapBuilder builder({.resolution_m = 0.1, .min_range_m = 0.0});
  std::vector<Eigen::Vector3d> points_m;
  for (const Eigen::Vector3f& c : views.target.map.voxels().centroids_m) {
    points_m.push_back(T_side_target * c.cast<double>());
  }
  builder.insert_points(points_m);
  lying.map = builder.finish();
  const Pose3 truth = T_side_target * views.T_target_source;
  const Eigen::Vector3d up = T_side_target.rotation() * Eigen::Vector3d::UnitZ();
  const Pose3 start = T_side_target * pose_at(2.0, 1.0, 0.0, 0.1) * views.T_target_source;
  const auto poses = coarse_search(views.source.map, lying.map, start, {5.0, 0.5, 0.35}, up, 6);
  double nearest_m = 99.0;
  for (const CoarsePose& pose : poses) {
    nearest_m = std::min(nearest_m, (truth.inverse() * pose.T_target_source).translation_m().norm());
  }
  EXPECT_LT(nearest_m, 0.6);
}

// A million moves are looked at here, and a handful returned.
TEST(CoarseSearch, MemoryDoesNotGrowWithTheRange) {
  const SubmapPair views = room_pair();
  kilter_testing::largest_allocation() = 0;
  const auto poses = coarse_search(views.source.map, views.target.map, views.T_target_source, {20.0, 0.5, 3.1},
                                   Eigen::Vector3d::UnitZ(), 6);
  EXPECT_LT(kilter_testing::largest_allocation(), 500'000U);
  EXPECT_EQ(poses.size(), 6U);
}

TEST(CoarseSearch, EmptyMapsGiveNothing) {
  const SubmapPair views = room_pair();
  EXPECT_TRUE(coarse_search(VoxelMap(), views.target.map, {}, {}, Eigen::Vector3d::UnitZ(), 6).empty());
  EXPECT_TRUE(coarse_search(views.source.map, VoxelMap(), {}, {}, Eigen::Vector3d::UnitZ(), 6).empty());
}

}  // namespace
}  // namespace kilter
