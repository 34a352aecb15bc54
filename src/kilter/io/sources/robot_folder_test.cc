// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/sources/robot_folder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "testing/source_folder.h"

namespace kilter {
namespace {

using kilter_testing::cloud_number;
using kilter_testing::expect_source_error;
using kilter_testing::only_robot;
using kilter_testing::open_source;
using kilter_testing::TempFolder;

// A quarter turn or so about z, its real part in front as EuRoC's files have it.
constexpr const char* kRealPartFirst = "timestamp [ns], x, y, z, q_w, q_x, q_y, q_z\n";

TEST(RobotFolder, ReadsPosesByTheirHeadingIfThereIsOne) {
  for (const std::string comment : {"", "#"}) {
    const TempFolder folder;
    folder.write("a/scans/000000.pcd", cloud_number(0));
    folder.write("a/poses.csv", comment + kRealPartFirst + "1403636579000000000,1,2,3,0.8,0,0,0.6\n");
    const RobotLog robot = only_robot(open_source(folder.path() / "a"), "robot folder");
    ASSERT_EQ(robot.T_world_cloud.size(), 1U);
    EXPECT_NEAR(robot.T_world_cloud[0].rotation().w(), 0.8, 1e-12);
    EXPECT_NEAR(robot.T_world_cloud[0].rotation().z(), 0.6, 1e-12);
    EXPECT_EQ(robot.stamps_ns, std::vector<std::int64_t>{1'403'636'579'000'000'000});
    EXPECT_EQ(robot.stamp_unit, "ns");
  }
}

TEST(RobotFolder, TakesEightColumnsUnderAHeadingThatOnlyRepeatsTheirOrder) {
  const TempFolder folder;
  for (int i = 0; i < 2; ++i) folder.write(fmt::format("a/scans/{}.pcd", i), cloud_number(i));
  folder.write("a/poses.tum", "# t x y z qx qy qz qw\n-1.5 0 0 0 0 0 0 1\n-1 1 0 0 0 0 0 1 # the last\n");
  const RobotLog robot = only_robot(open_source(folder.path() / "a"), "robot folder");
  ASSERT_EQ(robot.T_world_cloud.size(), 2U);
  EXPECT_EQ(robot.T_world_cloud[1].translation_m().x(), 1.0);
}

TEST(RobotFolder, RefusesAColumnOfNamesThatContradictsTheOrder) {
  const TempFolder folder;
  for (int i = 0; i < 2; ++i) folder.write(fmt::format("a/scans/{}.pcd", i), cloud_number(i));
  const std::string heading = "x y z qx qy qz qw file\n";
  folder.write("a/poses.txt", heading + "0 0 0 0 0 0 1 0\n1 0 0 0 0 0 1 some/1.pcd\n");
  EXPECT_EQ(only_robot(open_source(folder.path() / "a"), "robot folder").T_world_cloud.size(), 2U);
  folder.write("a/poses.txt", heading + "1 0 0 0 0 0 1 1.pcd\n0 0 0 0 0 0 1 0.pcd\n");
  expect_source_error(open_source(folder.path() / "a"), ErrorCode::kCountMismatch,
                      "pose 0 (the first being 0) names 1.pcd, but cloud 0 is 0.pcd");
}

}  // namespace
}  // namespace kilter
