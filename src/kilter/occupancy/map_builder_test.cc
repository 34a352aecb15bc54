// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/occupancy/map_builder.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "kilter/base/rng.h"

namespace kilter {
namespace {

const Eigen::Vector3d kOrigin(0.05, 0.05, 0.05);

TEST(MapBuilder, RayFreesTheVoxelsBeforeItsEnd) {
  MapBuilder builder({.resolution_m = 0.1, .min_range_m = 0.0});
  builder.insert_scan(std::vector{Eigen::Vector3d(1.05, 0.05, 0.05)}, kOrigin);
  const VoxelMap map = builder.finish();
  for (int x = 0; x < 10; ++x) EXPECT_EQ(map.state({x, 0, 0}), CellState::kFree) << x;
  EXPECT_EQ(map.state({10, 0, 0}), CellState::kOccupied);
  EXPECT_EQ(map.state({11, 0, 0}), CellState::kUnknown);
  EXPECT_EQ(map.state({5, 1, 0}), CellState::kUnknown);
  EXPECT_TRUE(map.has_free_space());
}

TEST(MapBuilder, CountsWhatLiesOffTheLattice) {
  MapBuilder builder({.resolution_m = 0.1, .min_range_m = 0.0});
  const std::vector<Eigen::Vector3d> points = {{1.05, 0.05, 0.05}, {1e6, 0.0, 0.0}};
  builder.insert_scan(points, kOrigin);
  EXPECT_EQ(builder.points_off_lattice(), 1U);
  builder.insert_points(points);
  EXPECT_EQ(builder.points_off_lattice(), 2U);
  builder.insert_scan(points, Eigen::Vector3d(1e6, 0.0, 0.0));
  EXPECT_EQ(builder.points_off_lattice(), 4U);
  EXPECT_EQ(builder.finish().voxels().size(), 1U);
}

TEST(MapBuilder, EveryTracedVoxelTouchesTheRay) {
  Rng rng(1, 0);
  for (int i = 0; i < 200; ++i) {
    MapBuilder builder({.resolution_m = 0.1, .min_range_m = 0.0});
    const Eigen::Vector3d end(rng.uniform(-3, 3), rng.uniform(-3, 3), rng.uniform(-3, 3));
    builder.insert_scan(std::vector{end}, kOrigin);
    const VoxelMap map = builder.finish();
    const Eigen::Vector3d direction = (end - kOrigin).normalized();
    int free_count = 0;
    for (const VoxelBlock& block : map.blocks()) {
      for (int bit = 0; bit < kBlockVoxels; ++bit) {
        const VoxelIndex voxel = voxel_of(block_of_key(block.key), bit);
        if (map.state(voxel) != CellState::kFree) continue;
        ++free_count;
        const Eigen::Vector3d offset = voxel_centre(voxel, 0.1) - kOrigin;
        EXPECT_LE((offset - offset.dot(direction) * direction).norm(), 0.1 * 0.8661);
      }
    }
    EXPECT_EQ(free_count, (voxel_at(end, 0.1) - voxel_at(kOrigin, 0.1)).cwiseAbs().sum());
  }
}

TEST(MapBuilder, HitWinsOverMissInsideOneScanAndEachCountsOnce) {
  MapBuilder builder({.resolution_m = 0.1, .min_range_m = 0.0});
  const std::vector<Eigen::Vector3d> two_ends = {{1.05, 0.05, 0.05}, {1.06, 0.05, 0.05}, {2.05, 0.05, 0.05}};
  builder.insert_scan(two_ends, kOrigin);
  const VoxelMap map = builder.finish();
  const auto voxel = map.find_voxel({10, 0, 0});
  ASSERT_GE(voxel, 0);
  EXPECT_NEAR(map.probability(static_cast<std::size_t>(voxel)), 0.7, 1e-6);
  EXPECT_NEAR(map.voxels().centroids_m[static_cast<std::size_t>(voxel)].x(), 1.055, 1e-6);
}

TEST(MapBuilder, ClampsProbabilitiesAndLetsMissesClearAVoxel) {
  MapBuilder builder({.resolution_m = 0.1, .min_range_m = 0.0});
  for (int i = 0; i < 20; ++i) builder.insert_scan(std::vector{Eigen::Vector3d(1.05, 0.05, 0.05)}, kOrigin);
  for (int i = 0; i < 3; ++i) builder.insert_scan(std::vector{Eigen::Vector3d(2.05, 0.05, 0.05)}, kOrigin);
  const VoxelMap seen = builder.finish();
  const auto voxel = seen.find_voxel({10, 0, 0});
  ASSERT_GE(voxel, 0);
  const double clamped = std::log(0.971 / 0.029) + 3.0 * std::log(0.4 / 0.6);
  EXPECT_NEAR(seen.voxels().log_odds[static_cast<std::size_t>(voxel)], clamped, 1e-5);

  MapBuilder cleared({.resolution_m = 0.1, .min_range_m = 0.0});
  cleared.insert_scan(std::vector{Eigen::Vector3d(1.05, 0.05, 0.05)}, kOrigin);
  for (int i = 0; i < 3; ++i) cleared.insert_scan(std::vector{Eigen::Vector3d(2.05, 0.05, 0.05)}, kOrigin);
  EXPECT_EQ(cleared.finish().state({10, 0, 0}), CellState::kFree);
}

TEST(MapBuilder, RangesLimitHitsAndFreeSpace) {
  MapBuilder builder({.resolution_m = 0.1, .min_range_m = 0.5, .max_range_m = 2.0});
  const std::vector<Eigen::Vector3d> near_and_far = {{0.25, 0.05, 0.05}, {5.05, 0.05, 0.05}};
  builder.insert_scan(near_and_far, kOrigin);
  const VoxelMap map = builder.finish();
  EXPECT_EQ(map.voxels().size(), 0U);
  EXPECT_EQ(map.state({15, 0, 0}), CellState::kFree);
  EXPECT_EQ(map.state({25, 0, 0}), CellState::kUnknown);
}

TEST(MapBuilder, PointsAloneLeaveEverythingElseUnknown) {
  MapBuilder builder({.resolution_m = 0.1});
  builder.insert_points(std::vector<Eigen::Vector3d>{{1.05, 0.05, 0.05}});
  const VoxelMap map = builder.finish();
  EXPECT_FALSE(map.has_free_space());
  EXPECT_EQ(map.voxels().size(), 1U);
  EXPECT_EQ(map.state({5, 0, 0}), CellState::kUnknown);
}

TEST(MapBuilder, WhatIsHitTooSeldomForTheThresholdIsNotFree) {
  const OccupancyOptions options{.resolution_m = 0.1, .occupancy_threshold = 0.9};
  MapBuilder builder(options);
  builder.insert_scan(std::vector<Eigen::Vector3d>{{1.05, 0.05, 0.05}}, {0.05, 0.05, 0.05});
  const VoxelMap scanned = builder.finish();
  EXPECT_EQ(scanned.state({10, 0, 0}), CellState::kUnknown);
  EXPECT_EQ(scanned.state({5, 0, 0}), CellState::kFree);
  builder.insert_points(std::vector<Eigen::Vector3d>{{1.05, 0.05, 0.05}});
  EXPECT_EQ(builder.finish().state({10, 0, 0}), CellState::kOccupied) << "of points alone nothing else is known";
}

TEST(OccupancyOptions, KnowWhatMakesAllOfAMapOccupied) {
  EXPECT_TRUE(validate(OccupancyOptions{}));
  EXPECT_TRUE(validate(OccupancyOptions{.occupancy_threshold = 0.41}));
  const auto fit = validate(OccupancyOptions{.occupancy_threshold = 0.4});
  ASSERT_FALSE(fit);
  EXPECT_NE(fit.error().message.find("expected more than probability_miss, which is 0.4"), std::string::npos);
  EXPECT_FALSE(validate(OccupancyOptions{.probability_miss = 0.5}));
}

TEST(MapBuilder, BeginsAnewOnceFinished) {
  MapBuilder builder({.resolution_m = 0.1});
  const std::vector<Eigen::Vector3f> scan_m = {{1.0F, 0.0F, 0.0F}, {0.0F, 1.0F, 0.0F}};
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(builder.insert_scan(scan_m, Pose3(), {}));
  EXPECT_TRUE(builder.finish().has_free_space());
  ASSERT_TRUE(builder.insert_points(scan_m, Pose3(), {}));
  EXPECT_FALSE(builder.finish().has_free_space()) << "of points alone nothing is known to be free";
}

TEST(MapBuilder, IgnoresWhatLiesOffTheLattice) {
  MapBuilder builder({.resolution_m = 0.1, .min_range_m = 0.0});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  builder.insert_scan(std::vector<Eigen::Vector3d>{{nan, 0.0, 0.0}, {1e30, 0.0, 0.0}, {0.05, 0.05, 0.05}}, kOrigin);
  EXPECT_EQ(builder.finish().voxels().size(), 0U);
}

TEST(MapBuilder, PointsAtOppositeEndsOfAFineLatticeAreVoxels) {
  const std::vector<Eigen::Vector3d> points = {{9999, 9999, 9999}, {-9999, -9999, -9999}, {1, 2, 3}, {-1, 2, -3}};
  MapBuilder builder({.resolution_m = 0.005});
  builder.insert_points(points);
  const VoxelMap map = builder.finish();
  EXPECT_EQ(map.voxels().size(), points.size());
  for (const Eigen::Vector3d& point : points) {
    const std::int64_t voxel = map.find_voxel(voxel_at(point, 0.005));
    ASSERT_GE(voxel, 0);
    EXPECT_EQ(map.voxels().centroids_m[static_cast<std::size_t>(voxel)], point.cast<float>());
  }
}

void expect_same(const VoxelMap& map, const VoxelMap& same) {
  EXPECT_EQ(map.indices(), same.indices());
  EXPECT_EQ(map.voxels().centroids_m, same.voxels().centroids_m);
  EXPECT_EQ(map.voxels().normals, same.voxels().normals);
  EXPECT_EQ(map.voxels().log_odds, same.voxels().log_odds);
  EXPECT_EQ(map.voxels().seen_at, same.voxels().seen_at);
  EXPECT_EQ(map.voxels().hits, same.voxels().hits);
  ASSERT_EQ(map.blocks().size(), same.blocks().size());
  for (std::size_t i = 0; i < map.blocks().size(); ++i) EXPECT_EQ(map.blocks()[i].free, same.blocks()[i].free);
}

TEST(MapBuilder, CloudsInTheirOwnFramesMakeTheMapOfTheirMovedPoints) {
  Rng rng(9, 0);
  const Pose3 T_map_scan(Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized())),
                         Eigen::Vector3d(3.0, -2.0, 1.0));
  for (const std::size_t count : {0U, 1U, 4096U, 10'000U}) {
    std::vector<Eigen::Vector3f> points;
    std::vector<Eigen::Vector3d> moved;
    for (std::size_t i = 0; i < count; ++i) {
      points.push_back(Eigen::Vector3d(rng.uniform(-40, 40), rng.uniform(-9, 9), rng.uniform(-9, 9)).cast<float>());
      moved.emplace_back(T_map_scan.isometry() * points.back().cast<double>());
    }
    MapBuilder scan({.resolution_m = 0.1});
    MapBuilder moved_scan({.resolution_m = 0.1});
    scan.insert_scan(points, T_map_scan, {});
    moved_scan.insert_scan(moved, T_map_scan.translation_m());
    expect_same(scan.finish(), moved_scan.finish());
    MapBuilder cloud({.resolution_m = 0.1});
    MapBuilder moved_cloud({.resolution_m = 0.1});
    cloud.insert_points(points, T_map_scan, {});
    moved_cloud.insert_points(moved);
    expect_same(cloud.finish(), moved_cloud.finish());
  }
}

TEST(MapBuilder, MoreHitsThanAreMarkedTogetherMakeTheSameMap) {
  Rng rng(10, 0);
  std::vector<Eigen::Vector3d> once;
  for (int i = 0; i < 300'000; ++i) once.emplace_back(rng.uniform(-9, 9), rng.uniform(-9, 9), rng.uniform(-9, 9));
  std::vector<Eigen::Vector3d> four_times = once;
  for (int time = 1; time < 4; ++time) four_times.insert(four_times.end(), once.begin(), once.end());
  MapBuilder few({.resolution_m = 0.1});
  MapBuilder many({.resolution_m = 0.1});
  few.insert_points(once);
  many.insert_points(four_times);
  const VoxelMap map = few.finish();
  const VoxelMap same = many.finish();
  EXPECT_EQ(map.indices(), same.indices());
  EXPECT_EQ(map.voxels().log_odds, same.voxels().log_odds);
}

TEST(MapBuilder, AskingWhetherToGoOnChangesNothingAndANoEndsTheScan) {
  const OccupancyOptions options = {.resolution_m = 0.1, .min_range_m = 0.0, .max_range_m = 3000.0};
  Rng rng(8, 0);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 1000; ++i) points.emplace_back(rng.uniform(-9, 9), rng.uniform(-9, 9), rng.uniform(-9, 9));
  MapBuilder alone(options);
  EXPECT_TRUE(alone.insert_scan(points, kOrigin));
  MapBuilder asked(options);
  std::vector<std::size_t> held_bytes;
  EXPECT_TRUE(asked.insert_scan(points, kOrigin, [&](std::size_t bytes) {
    held_bytes.push_back(bytes);
    return true;
  }));
  EXPECT_GT(held_bytes.size(), 10U) << "long rays are many voxels, so few are traced at once";
  EXPECT_TRUE(std::is_sorted(held_bytes.begin(), held_bytes.end()));
  EXPECT_GT(held_bytes.back(), held_bytes.front());
  const VoxelMap map = alone.finish();
  const VoxelMap same = asked.finish();
  EXPECT_EQ(map.indices(), same.indices());
  EXPECT_EQ(map.voxels().centroids_m, same.voxels().centroids_m);
  ASSERT_EQ(map.blocks().size(), same.blocks().size());
  for (std::size_t i = 0; i < map.blocks().size(); ++i) EXPECT_EQ(map.blocks()[i].free, same.blocks()[i].free);
  int questions = 0;
  MapBuilder stopped(options);
  EXPECT_FALSE(stopped.insert_scan(points, kOrigin, [&](std::size_t) { return ++questions < 3; }));
  EXPECT_EQ(questions, 3);
}

}  // namespace
}  // namespace kilter
