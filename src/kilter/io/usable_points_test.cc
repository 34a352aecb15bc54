// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/usable_points.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <limits>
#include <utility>
#include <vector>

namespace kilter {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

PointCloud cloud_of(int good, int nonfinite, int far) {
  PointCloud cloud;
  for (int i = 0; i < good; ++i) cloud.add(1.0F, 2.0F, 3.0F);
  for (int i = 0; i < nonfinite; ++i) cloud.add(kNan, 0.0F, 0.0F);
  for (int i = 0; i < far; ++i) cloud.add(691'000.0F, 5'334'000.0F, 500.0F);
  return cloud;
}

RobotLog robot_of(std::vector<PointCloud> clouds) {
  RobotLog log;
  log.name = "b";
  log.T_world_cloud.resize(clouds.size());
  log.read_cloud = [clouds = std::move(clouds)](std::size_t i) -> Expected<PointCloud> { return clouds[i]; };
  log.cloud_name = [](std::size_t i) { return fmt::format("{}.pcd", i); };
  return log;
}

void expect_unusable(const Expected<void>& checked, const std::string& part) {
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().code, ErrorCode::kInvalidPoints);
  EXPECT_NE(to_string(checked.error()).find(part), std::string::npos) << to_string(checked.error());
}

TEST(CheckUsable, SaysWhyNoPointOfACloudIs) {
  EXPECT_TRUE(check_usable(cloud_of(1, 9, 9), "a.pcd"));
  expect_unusable(check_usable(cloud_of(0, 3, 0), "a.pcd"),
                  "a.pcd: none of its 3 points can be used: 3 are not finite");
  expect_unusable(check_usable(cloud_of(0, 0, 4), "a.pcd"),
                  "4 lie beyond 10000 m from the origin\n  try: georeferenced?");
  expect_unusable(check_usable(cloud_of(0, 1, 1), "a.pcd"), "1 are not finite, 1 lie beyond");
  expect_unusable(check_usable(cloud_of(0, 0, 0), "a.pcd"), "a.pcd: expected points, found none");
}

TEST(CheckUsable, IsContentWithOneGoodCloudOfARobot) {
  EXPECT_TRUE(check_usable(robot_of({cloud_of(0, 3, 0), cloud_of(0, 0, 0), cloud_of(5, 0, 0)})));
  expect_unusable(check_usable(robot_of({cloud_of(0, 3, 0), cloud_of(0, 0, 0)})),
                  "0.pcd: none of its 3 points can be used: 3 are not finite; it is so with all 2 clouds of robot b");
  expect_unusable(check_usable(robot_of({cloud_of(0, 0, 1)})), "from the origin\n  try");
}

TEST(CheckUsable, LeavesWhatCannotBeReadToItsReader) {
  RobotLog log = robot_of({cloud_of(0, 3, 0), cloud_of(0, 3, 0)});
  log.read_cloud = [](std::size_t) -> Expected<PointCloud> { return fail(ErrorCode::kTruncated, "short", "f"); };
  EXPECT_TRUE(check_usable(log));
}

}  // namespace
}  // namespace kilter
