// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/sources/single_cloud.h"

#include "testing/source_folder.h"

namespace kilter {
namespace {

using namespace kilter_testing;  // a fixture's words

TEST(SingleCloud, IsOneFinishedSubmapInTheWorld) {
  const TempFolder folder;
  const auto first = folder.write("session1.pcd", cloud_number(0));
  const auto second = folder.write("session2.ply", ply_bytes("ascii", "4 2 3\n4 5 6\n"));
  const auto mission = open_mission({"a=" + first.string(), second.string()});
  ASSERT_TRUE(mission) << to_string(mission.error());
  ASSERT_EQ(mission->robots.size(), 2U);
  EXPECT_EQ(describe(mission->sources[0]), "single cloud, 1 submap, 1 robot");
  EXPECT_EQ(mission->robots[0].name, "a");
  EXPECT_EQ(mission->robots[1].name, "session2");
  for (const RobotLog& log : mission->robots) {
    EXPECT_TRUE(log.finished_submaps);
    ASSERT_EQ(log.T_world_cloud.size(), 1U);
    EXPECT_EQ(difference(log.T_world_cloud[0], Pose3()), 0.0);
  }
  EXPECT_EQ(first_point(mission->robots[1], 0).x(), 4.0F);
  EXPECT_EQ(mission->robots[0].cloud_name(0), first.string());
}

TEST(SingleCloud, IsNoBinFileAndNoFolder) {
  const TempFolder folder;
  expect_source_error(open_source(folder.write("a.bin", "")), ErrorCode::kUnsupported,
                      "a .bin file alone does not tell");
  std::filesystem::create_directory(folder.path() / "b.pcd");
  EXPECT_FALSE(is_single_cloud(folder.path() / "b.pcd"));
}

}  // namespace
}  // namespace kilter
