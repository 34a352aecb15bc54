// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/simulation/route.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace kilter {
namespace {

using Eigen::Vector3d;

RouteOptions steady() { return {.sway_rad = 0.0, .heave_m = 0.0}; }

double yaw_of(const Pose3& pose) {
  const Vector3d ahead = pose.rotation() * Vector3d::UnitX();
  return std::atan2(ahead.y(), ahead.x());
}

TEST(Trajectory, StraightDriveKeepsSpeedHeadingAndHeight) {
  const Trajectory drive = Trajectory::along({{1.0, 2.0, 0.5}, {1.0, 10.0, 0.5}}, steady());
  EXPECT_NEAR(drive.length_m(), 8.0, 1e-12);
  EXPECT_NEAR(drive.duration_s(), 10.0, 1e-12);
  const Pose3 middle = drive.at(5.0);
  EXPECT_LT((middle.translation_m() - Vector3d(1.0, 6.0, 1.2)).norm(), 1e-9);
  EXPECT_NEAR(yaw_of(middle), std::numbers::pi / 2.0, 1e-12);
  EXPECT_LT((drive.at(-3.0).translation_m() - drive.at(0.0).translation_m()).norm(), 1e-12) << "stands before";
  EXPECT_LT((drive.at(99.0).translation_m() - drive.at(10.0).translation_m()).norm(), 1e-12) << "stands after";
}

TEST(Trajectory, CornersAreRoundedWithoutJumps) {
  const Trajectory drive = Trajectory::along({{0.0, 0.0, 0.0}, {5.0, 0.0, 0.0}, {5.0, 5.0, 0.0}}, steady());
  EXPECT_LT(drive.length_m(), 10.0);
  EXPECT_GT(drive.length_m(), 9.0);
  for (double t = 0.0; t < drive.duration_s(); t += 0.02) {
    const Pose3 step = drive.at(t).inverse() * drive.at(t + 0.02);
    ASSERT_LT(step.translation_m().norm(), 0.8 * 0.02 + 1e-9);
    ASSERT_LT(step.angle_rad(), 0.08);
  }
  EXPECT_NEAR(yaw_of(drive.at(drive.duration_s())), std::numbers::pi / 2.0, 1e-9);
}

TEST(Trajectory, TurnsRoundOnTheSpotWhereTheWayGoesBack) {
  const Trajectory drive = Trajectory::along({{0.0, 0.0, 0.0}, {4.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}, steady());
  EXPECT_NEAR(drive.length_m(), 8.0, 1e-9);
  EXPECT_NEAR(drive.duration_s(), 10.0 + std::numbers::pi / 0.8, 1e-9);
  const double turning_s = 5.0 + 0.5 * std::numbers::pi / 0.8;
  EXPECT_LT((drive.at(turning_s).translation_m() - Vector3d(4.0, 0.0, 0.7)).norm(), 1e-9);
  EXPECT_NEAR(std::abs(yaw_of(drive.at(turning_s))), std::numbers::pi / 2.0, 1e-9);
}

TEST(Trajectory, ClimbsWithItsNoseUp) {
  const Trajectory drive = Trajectory::along({{0.0, 0.0, 0.0}, {4.0, 0.0, 0.0}, {8.0, 0.0, 2.0}}, steady());
  const Pose3 climbing = drive.at(drive.duration_s() - 2.0);
  EXPECT_GT((climbing.rotation() * Vector3d::UnitX()).z(), 0.4);
  EXPECT_NEAR(drive.at(drive.duration_s()).translation_m().z(), 2.7, 1e-9);
}

TEST(Trajectory, ScansComeAtTheAskedSpacing) {
  const Trajectory drive = Trajectory::along({{0.0, 0.0, 0.0}, {20.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}, steady());
  const std::vector<double> times_s = drive.scan_times_s(0.5, 0.5);
  ASSERT_GT(times_s.size(), 80U);
  for (std::size_t i = 1; i < times_s.size(); ++i) {
    const Pose3 step = drive.at(times_s[i - 1]).inverse() * drive.at(times_s[i]);
    ASSERT_GT(times_s[i], times_s[i - 1]);
    ASSERT_LT(step.translation_m().norm(), 0.56);
    ASSERT_LT(step.angle_rad(), 0.6);
  }
}

TEST(Trajectory, SwayStaysSmallAndDependsOnTheSeed) {
  const std::vector<Vector3d> way = {{0.0, 0.0, 0.0}, {30.0, 0.0, 0.0}};
  const Trajectory first = Trajectory::along(way, {.seed = 1});
  const Trajectory second = Trajectory::along(way, {.seed = 2});
  double squares = 0.0;
  int count = 0;
  for (double t = 0.0; t < first.duration_s(); t += 0.1, ++count) {
    const double tilt = std::acos((first.at(t).rotation() * Vector3d::UnitZ()).z());
    squares += tilt * tilt;
  }
  EXPECT_NEAR(std::sqrt(squares / count), 0.005 * std::sqrt(2.0), 0.0015);
  EXPECT_GT((first.at(3.0).inverse() * second.at(3.0)).angle_rad(), 1e-5);
}

}  // namespace
}  // namespace kilter
