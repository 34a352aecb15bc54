// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/submap/build_submaps.h"

#include <atomic>

#include <gtest/gtest.h>

#include "kilter/base/rng.h"
#include "testing/allocation_watch.h"

namespace kilter {
namespace {

// A robot driving along x past a wall at y = 2, seen by every scan.
RobotLog wall_log(int scans) {
  RobotLog log;
  log.name = "a";
  for (int i = 0; i < scans; ++i) log.T_world_cloud.push_back(Pose3::from_translation(100.0 + i, 50.0, 1.0));
  log.read_cloud = [](std::size_t) -> Expected<PointCloud> {
    PointCloud cloud;
    for (int k = -100; k <= 100; ++k) cloud.add(0.05F * static_cast<float>(k) + 0.013F, 2.03F, 0.02F);
    cloud.add(std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F);
    return cloud;
  };
  log.cloud_name = [](std::size_t i) { return std::to_string(i); };
  return log;
}

TEST(BuildSubmaps, CutsNamesAndPlacesThem) {
  const auto submaps = build_submaps(wall_log(25), 3, {}, {});
  ASSERT_TRUE(submaps.has_value());
  ASSERT_EQ(submaps->size(), 3U);
  const Submap& second = (*submaps)[1];
  EXPECT_EQ(second.name, "a/2");
  EXPECT_EQ(second.robot, 3);
  EXPECT_EQ(second.scans->first, 10U);
  EXPECT_EQ(second.origins_m.size(), 10U);
  EXPECT_NEAR(second.path_start_m, 10.0, 1e-12);
  EXPECT_NEAR(second.T_world_submap.translation_m().x(), 110.0, 1e-12);
  EXPECT_GT(second.map.voxels().size(), 150U);
  EXPECT_TRUE(second.map.has_free_space());
  EXPECT_EQ(second.dropped_points, 10U);
}

TEST(BuildSubmaps, PointsOfScansFarFromTheirSubmapAreCountedAsDropped) {
  RobotLog log = wall_log(3);
  for (std::size_t i = 1; i < 3; ++i) log.T_world_cloud[i] = Pose3::from_translation(691'000.0, 5'334'000.0, 500.0);
  const auto submaps = build_submaps(log, 0, {}, {}, std::vector<ScanRange>{{0, 2}});
  ASSERT_EQ(submaps->size(), 1U);
  EXPECT_GT((*submaps)[0].map.voxels().size(), 90U);
  EXPECT_EQ((*submaps)[0].dropped_points, 3U + 2U * 201U);
}

TEST(BuildSubmaps, ThreadsChangeNothing) {
  const auto one = build_submaps(wall_log(40), 0, {}, {.threads = 1});
  const auto four = build_submaps(wall_log(40), 0, {}, {.threads = 4});
  ASSERT_EQ(one->size(), four->size());
  for (std::size_t i = 0; i < one->size(); ++i) {
    EXPECT_EQ((*one)[i].map.indices(), (*four)[i].map.indices());
    EXPECT_EQ((*one)[i].map.voxels().centroids_m, (*four)[i].map.voxels().centroids_m);
  }
}

TEST(BuildSubmaps, MovingTheWorldChangesNoVoxel) {
  RobotLog moved = wall_log(15);
  const Pose3 shift(Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized())),
                    Eigen::Vector3d(1000.0, -2000.0, 300.0));
  for (Pose3& pose : moved.T_world_cloud) pose = shift * pose;
  const auto here = build_submaps(wall_log(15), 0, {}, {});
  const auto there = build_submaps(moved, 0, {}, {});
  EXPECT_EQ((*here)[0].map.indices(), (*there)[0].map.indices());
}

TEST(BuildSubmaps, FinishedSubmapsAreOnePerCloudWithoutFreeSpace) {
  RobotLog log = wall_log(3);
  log.finished_submaps = true;
  const auto submaps = build_submaps(log, 0, {}, {});
  ASSERT_EQ(submaps->size(), 3U);
  EXPECT_FALSE((*submaps)[0].map.has_free_space());
  EXPECT_FALSE((*submaps)[0].scans.has_value());
}

TEST(BuildSubmaps, GivenCutsAreUsedOrRefused) {
  const std::vector<ScanRange> cuts = {{0, 3}, {4, 11}};
  const auto submaps = build_submaps(wall_log(12), 0, {}, {}, cuts);
  ASSERT_EQ(submaps->size(), 2U);
  EXPECT_EQ((*submaps)[0].scans->last, 3U);
  for (const auto& bad : {std::vector<ScanRange>{{0, 3}, {5, 11}}, {{0, 3}}, {{0, 20}}}) {
    EXPECT_EQ(build_submaps(wall_log(12), 0, {}, {}, bad).error().code, ErrorCode::kCountMismatch);
  }
}

TEST(BuildSubmaps, ReadingErrorsAndCancellationComeBack) {
  RobotLog log = wall_log(12);
  log.read_cloud = [](std::size_t) -> Expected<PointCloud> { return fail(ErrorCode::kParse, "broken"); };
  EXPECT_EQ(build_submaps(log, 0, {}, {}).error().message, "broken");
  const std::atomic<bool> cancelled = true;
  EXPECT_EQ(build_submaps(wall_log(12), 0, {}, {.cancelled = &cancelled}).error().code, ErrorCode::kCancelled);
}

TEST(BuildSubmaps, NoSubmapIsBegunAfterOneThatFailed) {
  for (const int threads : {1, 2}) {
    std::atomic<int> reads = 0;
    RobotLog log = wall_log(400);
    log.read_cloud = [&reads, read = log.read_cloud](std::size_t scan) -> Expected<PointCloud> {
      ++reads;
      if (scan == 3 || scan == 11) return fail(ErrorCode::kParse, "broken", std::to_string(scan));
      return read(scan);
    };
    const auto submaps = build_submaps(log, 0, {}, {.threads = threads});
    ASSERT_FALSE(submaps);
    EXPECT_EQ(submaps.error().where, "3") << threads;
    EXPECT_LE(reads, threads == 1 ? 4 : 200);
  }
}

// A scan whose rays go 90 m into all directions of space.
RobotLog scattered_log() {
  RobotLog log = wall_log(2);
  log.read_cloud = [](std::size_t) -> Expected<PointCloud> {
    Rng rng(5, 0);
    PointCloud cloud;
    for (int k = 0; k < 30'000; ++k) {
      const Eigen::Vector3d at_m = 90.0 * Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal()).normalized();
      cloud.add(static_cast<float>(at_m.x()), static_cast<float>(at_m.y()), static_cast<float>(at_m.z()));
    }
    return cloud;
  };
  return log;
}

TEST(BuildSubmaps, AMapThatOutgrowsTheBudgetWhileItIsMadeEndsTheRunAtItsScan) {
  SubmapOptions options;
  options.occupancy.max_range_m = 100.0;
  const auto submaps = build_submaps(scattered_log(), 0, options, {.memory_bytes = 1'000'000});
  ASSERT_FALSE(submaps);
  EXPECT_EQ(submaps.error().code, ErrorCode::kOutOfMemory);
  EXPECT_EQ(submaps.error().where, "0");
  EXPECT_NE(submaps.error().message.find("may take 268 MB"), std::string::npos) << submaps.error().message;
}

TEST(BuildSubmaps, ABudgetIsHeldAgainstPointsBeforeTheyAreTaken) {
  for (const bool finished : {false, true}) {
    RobotLog log = wall_log(1);
    log.finished_submaps = finished;
    log.read_cloud = [](std::size_t) -> Expected<PointCloud> {
      PointCloud cloud;
      cloud.points_m.assign(7'000'000, {5.0F, 5.0F, 5.0F});
      return cloud;
    };
    kilter_testing::largest_allocation() = 0;
    const auto submaps = build_submaps(log, 0, {}, {.memory_bytes = 1'000'000});
    ASSERT_FALSE(submaps);
    EXPECT_EQ(submaps.error().code, ErrorCode::kOutOfMemory);
    EXPECT_NE(submaps.error().message.find("takes 280 MB"), std::string::npos) << submaps.error().message;
    EXPECT_EQ(kilter_testing::largest_allocation(), 7'000'000 * sizeof(Eigen::Vector3f)) << "the cloud itself";
  }
}

TEST(BuildSubmaps, AStopIsHeardAfterTheLastScanWasRead) {
  std::atomic<bool> stop = false;
  RobotLog log = scattered_log();
  log.T_world_cloud.resize(1);
  log.read_cloud = [&stop, read = log.read_cloud](std::size_t scan) {
    stop = true;
    return read(scan);
  };
  SubmapOptions options;
  options.occupancy.max_range_m = 100.0;
  const auto submaps = build_submaps(log, 0, options, {.cancelled = &stop});
  ASSERT_FALSE(submaps);
  EXPECT_EQ(submaps.error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace kilter
