// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/bag_source.h"

#include <gtest/gtest.h>

#include "testing/bag_walk.h"
#include "testing/source_folder.h"

namespace kilter {
namespace {

using kilter_testing::cloud_number;
using kilter_testing::expect_source_error;
using kilter_testing::mcap_bytes;
using kilter_testing::notes_of;
using kilter_testing::only_robot;
using kilter_testing::open_source;
using kilter_testing::RosDialect;
using kilter_testing::small_drive;
using kilter_testing::TempFolder;

constexpr const char* kKind = "ROS 2 bag (MCAP)";

std::string a_bag() { return mcap_bytes(small_drive(RosDialect::kCdrLittle)); }

TEST(BagSource, LeavesOtherSourcesBesideABagToThemselves) {
  const TempFolder folder;
  folder.write("s/a/0.pcd", cloud_number(0));
  folder.write("s/a/poses.tum", "0 0 0 0 0 0 0 1\n");
  folder.write("s/b/run_0.mcap", a_bag());
  folder.write("s/raw.mcap", a_bag());
  const auto mission = open_source(folder.path() / "s");
  ASSERT_TRUE(mission) << to_string(mission.error());
  ASSERT_EQ(mission->robots.size(), 2U);
  EXPECT_EQ(mission->robots[0].kind, "folder of clouds");
  EXPECT_EQ(mission->robots[1].kind, kKind);
  EXPECT_NE(notes_of(mission).find("beside robot a: raw.mcap is of another kind"), std::string::npos)
      << notes_of(mission);
}

TEST(BagSource, IsFoundBesideLinksThatLeadRoundAndRound) {
  const TempFolder folder;
  folder.write("run/run_0.mcap", a_bag());
  for (const char* name : {"a", "b", "c"}) std::filesystem::create_directory_symlink(".", folder.path() / "run" / name);
  EXPECT_EQ(only_robot(open_source(folder.path() / "run"), kKind).T_world_cloud.size(), 4U);
  folder.write("clouds/0.pcd", cloud_number(0));
  folder.write("clouds/poses.tum", "0 0 0 0 0 0 0 1\n");
  for (const char* name : {"a", "b", "c"}) {
    std::filesystem::create_directory_symlink(".", folder.path() / "clouds" / name);
  }
  EXPECT_EQ(only_robot(open_source(folder.path() / "clouds"), "folder of clouds").T_world_cloud.size(), 1U);
}

TEST(BagSource, AsksWhichOfSeveralFormatsIsMeant) {
  const TempFolder folder;
  folder.write("run/monday_0.mcap", a_bag());
  folder.write("run/wednesday.bag", "");
  expect_source_error(open_source(folder.path() / "run"), ErrorCode::kUnsupported,
                      "expected one recording, found monday_0.mcap and wednesday.bag");
}

TEST(BagSource, TakesOfSeveralRecordingsTheOneThatIsListed) {
  const TempFolder folder;
  folder.write("run/run_0.mcap", a_bag());
  folder.write("run/run_0_recovered.mcap", a_bag());
  expect_source_error(open_source(folder.path() / "run"), ErrorCode::kUnsupported,
                      "expected the parts of one recording (NAME_0.mcap, NAME_1.mcap, ...), found run_0.mcap and "
                      "run_0_recovered.mcap");
  folder.write("run/metadata.yaml",
               "rosbag2_bagfile_information:\n  version: 5\n  relative_file_paths:\n    - \"run_0.mcap\"\n  files:\n"
               "    - path: run_0_recovered.mcap\n");
  const auto mission = open_source(folder.path() / "run");
  EXPECT_EQ(only_robot(mission, kKind).T_world_cloud.size(), 4U);
  EXPECT_NE(notes_of(mission).find("robot run: run_0_recovered.mcap is left out, since metadata.yaml does not list it"),
            std::string::npos)
      << notes_of(mission);
}

TEST(BagSource, PutsTheSensorOnABodyWhoseCloudsAreDrawnInTheWorld) {
  const std::int64_t stamp_ns = 1'700'000'000'000'000'000;
  const auto dialect = RosDialect::kCdrLittle;
  const TempFolder folder;
  const auto file = folder.write(
      "run.mcap",
      mcap_bytes({{"/points", "sensor_msgs/PointCloud2", stamp_ns,
                   kilter_testing::cloud_message(dialect, stamp_ns, "odom", 2)},
                  {"/odom", "nav_msgs/Odometry", stamp_ns,
                   kilter_testing::odometry_message(dialect, stamp_ns, "odom", "base", kilter_testing::at_x(5))}}));
  const auto at = [](const RobotLog& log) -> Eigen::Vector3d {
    return log.T_world_cloud.at(0) * log.read_cloud(0)->points_m.at(0).cast<double>().eval();
  };
  const auto as_given = open_mission({file.string()});
  ASSERT_TRUE(as_given) << to_string(as_given.error());
  const Pose3 T_body_sensor(Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ())), {0.3, 0.0, 0.5});
  const auto mounted = open_mission({file.string()}, {.poses_folder = {}, .T_body_sensor = {{"", T_body_sensor}}});
  ASSERT_TRUE(mounted) << to_string(mounted.error());
  EXPECT_NEAR((mounted->robots[0].T_world_cloud[0].translation_m() - Eigen::Vector3d(5.3, 0.0, 0.5)).norm(), 0.0,
              1e-12);
  EXPECT_NEAR((at(mounted->robots[0]) - at(as_given->robots[0])).norm(), 0.0, 1e-5) << "a point of the world stays";
}

}  // namespace
}  // namespace kilter
