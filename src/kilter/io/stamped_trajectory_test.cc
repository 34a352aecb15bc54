// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/stamped_trajectory.h"

#include <gtest/gtest.h>

#include <numbers>

namespace kilter {
namespace {

// At x = stamp, turned about z by a hundredth of it.
StampedPose at_x(std::int64_t stamp) {
  const double x = static_cast<double>(stamp);
  return {stamp, Pose3(Eigen::Quaterniond(Eigen::AngleAxisd(0.01 * x, Eigen::Vector3d::UnitZ())), {x, 0, 0})};
}

TEST(StampedTrajectory, SortsAndKeepsTheFirstOfOneTime) {
  StampedPose other = at_x(20);
  other.T_world_body = Pose3();
  const StampedTrajectory trajectory({at_x(20), at_x(10), other, at_x(0)});
  ASSERT_EQ(trajectory.poses().size(), 3U);
  EXPECT_EQ(trajectory.poses()[2].T_world_body.translation_m().x(), 20.0);
}

TEST(StampedTrajectory, InterpolatesInsideSmallGapsOnly) {
  const StampedTrajectory trajectory({at_x(0), at_x(10), at_x(100)});
  EXPECT_EQ(trajectory.at(10, 0, 0)->translation_m().x(), 10.0);
  const auto between = trajectory.at(4, 10, 0);
  ASSERT_TRUE(between);
  EXPECT_NEAR(between->translation_m().x(), 4.0, 1e-12);
  EXPECT_NEAR(between->angle_rad(), 0.04, 1e-12);
  EXPECT_FALSE(trajectory.at(55, 89, 0));
  EXPECT_NEAR(trajectory.at(55, 90, 0)->translation_m().x(), 55.0, 1e-12);
  EXPECT_FALSE(StampedTrajectory({}).at(0, 10, 10));
}

TEST(StampedTrajectory, TakesANeighbourWithinTheSlack) {
  const StampedTrajectory trajectory({at_x(10), at_x(100)});
  EXPECT_FALSE(trajectory.at(7, 10, 2));
  EXPECT_EQ(trajectory.at(7, 10, 3)->translation_m().x(), 10.0);
  EXPECT_EQ(trajectory.at(12, 10, 3)->translation_m().x(), 10.0);
  EXPECT_EQ(trajectory.at(98, 10, 3)->translation_m().x(), 100.0);
  EXPECT_EQ(trajectory.at(103, 10, 3)->translation_m().x(), 100.0);
  EXPECT_FALSE(trajectory.at(104, 10, 3));
}

TEST(StampedTrajectory, SurvivesTheEndsOfTime) {
  const StampedTrajectory trajectory({at_x(INT64_MIN), at_x(INT64_MAX)});
  EXPECT_FALSE(trajectory.at(0, 1'000'000'000, 1'000'000'000));
}

TEST(ParseStamp, KeepsNanoseconds) {
  EXPECT_EQ(parse_stamp_ns("1403636579.763555584"), 1403636579763555584);
  EXPECT_EQ(parse_stamp_ns("0"), 0);
  EXPECT_EQ(parse_stamp_ns("12."), 12'000'000'000);
  EXPECT_EQ(parse_stamp_ns("12.5"), 12'500'000'000);
  EXPECT_EQ(parse_stamp_ns("0.0000000019"), 1);
  for (const char* word : {"", ".", ".5", "-1", "1e9", "1.2.3", "9223372036", "99999999999999999999", "nan", "1,5"}) {
    EXPECT_FALSE(parse_stamp_ns(word)) << word;
  }
}

}  // namespace
}  // namespace kilter
