// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/submap/fuse_submaps.h"

#include <gtest/gtest.h>

#include <cmath>

#include "kilter/occupancy/map_builder.h"

namespace kilter {
namespace {

Submap submap_seeing(const std::vector<Eigen::Vector3d>& points_m, const Pose3& T_world_submap, int robot) {
  Submap submap;
  submap.robot = robot;
  submap.T_world_submap = T_world_submap;
  MapBuilder builder({.resolution_m = 0.1, .min_range_m = 0.0});
  builder.insert_scan(points_m, {0.05, 0.05, 0.05});
  submap.map = builder.finish();
  return submap;
}

std::vector<FusedVoxel> fused_of(std::vector<Submap> submaps) {
  for (std::size_t i = 0; i < submaps.size(); ++i) submaps[i].id = {static_cast<int>(i)};
  const LendMap lend = [&](SubmapId id, const std::function<void(const VoxelMap&)>& use) -> Expected<void> {
    use(submaps[static_cast<std::size_t>(id.value)].map);
    return {};
  };
  return fuse_submaps(std::vector<SubmapNode>(submaps.begin(), submaps.end()), lend, {}).value();
}

TEST(FuseSubmaps, SumsLogOddsWhereSubmapsAgree) {
  const Submap a = submap_seeing({{1.05, 0.05, 0.05}}, Pose3::from_translation(5.0, 0.0, 0.0), 0);
  const Submap b = submap_seeing({{2.05, 0.05, 0.05}}, Pose3::from_translation(4.0, 0.0, 0.0), 1);
  const std::vector<FusedVoxel> fused = fused_of({a, b});
  ASSERT_EQ(fused.size(), 1U);
  EXPECT_NEAR(fused[0].log_odds, 2.0 * std::log(0.7 / 0.3), 1e-6);
  EXPECT_LT((fused[0].centroid_world_m - Eigen::Vector3d(6.05, 0.05, 0.05)).norm(), 1e-6);
  EXPECT_EQ(fused[0].robot, 0);
}

TEST(FuseSubmaps, FreeSpaceOfOneLowersWhatAnotherSawButKeepsIt) {
  const Submap a = submap_seeing({{1.05, 0.05, 0.05}}, {}, 0);
  const Submap b = submap_seeing({{2.05, 0.05, 0.05}, {0.55, 0.55, 0.05}}, {}, 0);
  const std::vector<FusedVoxel> fused = fused_of({a, b});
  ASSERT_EQ(fused.size(), 3U);
  double lowest = 10.0;
  for (const FusedVoxel& voxel : fused) lowest = std::min(lowest, voxel.log_odds);
  EXPECT_NEAR(lowest, std::log(0.7 / 0.3) + std::log(0.4 / 0.6), 1e-6);  // the near wall, seen through by b
}

// Two lattices 8 cm apart: the mean of both hits lies in the voxel before the one that b hit, which its ray went
// through.
TEST(FuseSubmaps, ASubmapHoldsNoMissAgainstACellThatItHit) {
  const Submap a = submap_seeing({{1.01, 0.05, 0.05}}, {}, 0);
  const Submap b = submap_seeing({{1.01, 0.05, 0.05}, {0.55, 0.55, 0.05}}, Pose3::from_translation(0.08, 0.0, 0.0), 1);
  const std::vector<FusedVoxel> fused = fused_of({a, b});
  ASSERT_EQ(fused.size(), 2U);
  EXPECT_NEAR(fused[0].centroid_world_m.x(), 1.05, 1e-6);
  EXPECT_NEAR(fused[0].log_odds, 2.0 * std::log(0.7 / 0.3), 1e-6);
}

TEST(FuseSubmaps, PassesOnWhyThereIsNoMap) {
  const LendMap lend = [](SubmapId, const std::function<void(const VoxelMap&)>&) -> Expected<void> {
    return fail(ErrorCode::kNoSpace, "full");
  };
  EXPECT_EQ(fuse_submaps(std::vector<SubmapNode>(1), lend, {}).error().code, ErrorCode::kNoSpace);
}

TEST(FuseSubmaps, WorksFarFromTheOrigin) {
  const Submap a = submap_seeing({{1.05, 0.05, 0.05}}, Pose3::from_translation(5e5, 5e6, 100.0), 0);
  const std::vector<FusedVoxel> fused = fused_of({a});
  ASSERT_EQ(fused.size(), 1U);
  EXPECT_NEAR(fused[0].centroid_world_m.x(), 500001.05, 1e-5);
}

}  // namespace
}  // namespace kilter
