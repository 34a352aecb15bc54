// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Recorded missions, if there are any on this machine.
#include "testing/real_data.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "kilter/io/mission.h"

namespace kilter {
namespace {

namespace fs = std::filesystem;

// The number behind POINTS, found by other means than our reader's.
std::size_t points_said(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string word;
  while (stream >> word && word != "POINTS") {
  }
  std::size_t points = 0;
  stream >> points;
  return points;
}

void check_mission(const fs::path& folder, const MissionOptions& options) {
  const auto mission = open_mission({folder.string()}, options);
  ASSERT_TRUE(mission) << to_string(mission.error());
  EXPECT_TRUE(mission->notes.empty());
  for (const RobotLog& robot : mission->robots) {
    for (std::size_t i = 0; i < robot.T_world_cloud.size(); ++i) {
      const auto cloud = robot.read_cloud(i);
      ASSERT_TRUE(cloud) << to_string(cloud.error());
      EXPECT_GT(cloud->points_m.size(), 100U) << robot.cloud_name(i);
      EXPECT_EQ(cloud->points_m.size() + cloud->dropped_nonfinite + cloud->dropped_far,
                points_said(robot.cloud_name(i)))
          << robot.cloud_name(i);
      // A field read at the wrong offset gives lengths of any size, not a lidar's.
      for (const Eigen::Vector3f& point_m : cloud->points_m) ASSERT_LT(point_m.norm(), 500.0F) << robot.cloud_name(i);
    }
  }
}

TEST(RealData, IsReadWhole) {
  const auto data = kilter_testing::real_data();
  if (!data) GTEST_SKIP() << "no recorded missions: set KILTER_DATA";
  int missions = 0;
  for (const auto& entry : fs::directory_iterator(*data)) {
    if (!fs::is_directory(entry.path() / "mission")) continue;
    SCOPED_TRACE(entry.path().string());
    check_mission(entry.path() / "mission", {});
    ++missions;
  }
  EXPECT_GT(missions, 0);
}

TEST(RealData, IsReadUnderItsTruePoses) {
  const auto data = kilter_testing::real_data();
  if (!data) GTEST_SKIP() << "no recorded missions: set KILTER_DATA";
  for (const char* name : {"garage", "loop"}) {
    if (!fs::is_directory(*data / name)) continue;
    SCOPED_TRACE(name);
    const fs::path truth = *data / name / "truth";
    const auto given = open_mission({(*data / name / "mission").string()});
    const auto moved =
        open_mission({(*data / name / "mission").string()}, {.poses_folder = truth, .T_body_sensor = {}});
    ASSERT_TRUE(given && moved);
    ASSERT_EQ(given->robots.size(), 2U);
    ASSERT_EQ(moved->robots.size(), 2U);
    const Pose3 change = given->robots[1].T_world_cloud.back().inverse() * moved->robots[1].T_world_cloud.back();
    EXPECT_GT(change.log().norm(), 0.01);
  }
}

}  // namespace
}  // namespace kilter
