// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/submap/cutting.h"

#include <gtest/gtest.h>

#include <numbers>

namespace kilter {
namespace {

std::vector<Pose3> straight(int count, double step_m) {
  std::vector<Pose3> poses;
  for (int i = 0; i < count; ++i) poses.push_back(Pose3::from_translation(step_m * i, 0.0, 0.0));
  return poses;
}

TEST(CutTrajectory, BeginsANewSubmapEveryTenMetres) {
  const std::vector<ScanRange> expected = {{0, 9}, {10, 19}, {20, 29}};
  EXPECT_EQ(cut_trajectory(straight(30, 1.0)), expected);
}

TEST(CutTrajectory, ShortTailJoinsItsPredecessor) {
  const std::vector<ScanRange> joined = {{0, 9}, {10, 22}};
  EXPECT_EQ(cut_trajectory(straight(23, 1.0)), joined);
  const std::vector<ScanRange> kept = {{0, 9}, {10, 19}, {20, 23}};
  EXPECT_EQ(cut_trajectory(straight(24, 1.0)), kept);
}

TEST(CutTrajectory, ScansFartherApartThanASubmapStandAlone) {
  const std::vector<ScanRange> expected = {{0, 0}, {1, 1}, {2, 2}};
  EXPECT_EQ(cut_trajectory(straight(3, 12.0)), expected);
}

TEST(CutTrajectory, TurningOnTheSpotCuts) {
  std::vector<Pose3> poses;
  for (int i = 0; i < 40; ++i) {
    const double angle = i * 10.0 * std::numbers::pi / 180.0;
    poses.emplace_back(Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ())), Eigen::Vector3d::Zero());
  }
  const std::vector<ScanRange> ranges = cut_trajectory(poses);
  ASSERT_EQ(ranges.size(), 2U);
  EXPECT_EQ(ranges[0].last, 17U);
}

TEST(CutTrajectory, MinScansHoldsTheCutBack) {
  const std::vector<ScanRange> ranges = cut_trajectory(straight(12, 12.0), {.min_scans = 5});
  const std::vector<ScanRange> expected = {{0, 4}, {5, 11}};
  EXPECT_EQ(ranges, expected);
}

TEST(CutTrajectory, NothingAndOneScan) {
  EXPECT_TRUE(cut_trajectory({}).empty());
  const std::vector<ScanRange> one = {{0, 0}};
  EXPECT_EQ(cut_trajectory(straight(1, 1.0)), one);
}

TEST(CutTrajectory, RangesCoverEveryScanOnce) {
  for (int count = 1; count < 80; ++count) {
    std::size_t next = 0;
    for (const ScanRange& range : cut_trajectory(straight(count, 0.7))) {
      EXPECT_EQ(range.first, next);
      EXPECT_GE(range.last, range.first);
      next = range.last + 1;
    }
    EXPECT_EQ(next, static_cast<std::size_t>(count));
  }
}

}  // namespace
}  // namespace kilter
