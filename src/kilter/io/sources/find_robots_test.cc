// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/sources/find_robots.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "testing/restricted.h"
#include "testing/source_folder.h"

namespace kilter {
namespace {

using kilter_testing::cloud_number;
using kilter_testing::expect_source_error;
using kilter_testing::open_source;
using kilter_testing::pose_number;
using kilter_testing::Restricted;
using kilter_testing::TempFolder;
using kilter_testing::tum_columns;
namespace fs = std::filesystem;

std::string one_pose() { return "0 " + tum_columns(pose_number(0)) + "\n"; }

void write_robot(const TempFolder& folder, const std::string& name) {
  folder.write(name + "/poses.tum", one_pose());
  folder.write(name + "/scans/000000.pcd", cloud_number(0));
}

TEST(FindRobots, AResultOfCheckIsToldFromAMission) {
  const TempFolder folder;
  folder.write("out/result.json", "{}");
  folder.write("out/coloured.ply", "");
  EXPECT_EQ(open_mission({(folder.path() / "out").string()}).error().code, ErrorCode::kNotFound) << "somebody else's";
  folder.write("out/result.kilter", "");
  for (const std::string name : {"", "r="}) {
    for (const char* const inside : {"out", "out/", "out/result.json", "out/result.kilter"}) {
      const auto mission = open_mission({name + (folder.path() / inside).string()});
      ASSERT_FALSE(mission) << name << inside;
      EXPECT_EQ(mission.error().message, "this is a result of kilter check, no mission") << name << inside;
      EXPECT_NE(mission.error().hint.find("kilter report"), std::string::npos);
    }
  }
}

// A mission of robots a and c, of which c is to be spoilt.
struct TwoRobots {
  TempFolder folder;
  fs::path a = folder.path() / "a";
  fs::path c = folder.path() / "c";

  TwoRobots() {
    write_robot(folder, "a");
    write_robot(folder, "c");
  }

  void expect_refused(ErrorCode code, std::string_view message_part) const {
    expect_source_error(open_source(folder.path()), code, message_part);
    expect_source_error(open_mission({"c=" + c.string()}), code, message_part);
  }
};

TEST(FindRobots, LeavesNoFolderOutThatItMayNotRead) {
  const TwoRobots mission;
  ASSERT_TRUE(open_source(mission.folder.path()));
  {
    const Restricted restricted(mission.folder, "c", 0);
    mission.expect_refused(ErrorCode::kIo, "c: cannot be listed: Permission denied");
  }
  {
    const Restricted restricted(mission.folder, "c", 0444);
    mission.expect_refused(ErrorCode::kIo, "c: cannot be read: Permission denied");
  }
  {
    const Restricted restricted(mission.folder, "c/scans", 0);
    mission.expect_refused(ErrorCode::kIo, "c/scans: cannot be listed: Permission denied");
  }
  const Restricted restricted(mission.folder, "c/scans", 0444);
  mission.expect_refused(ErrorCode::kIo, "c/scans/000000.pcd: cannot be read: Permission denied");
}

TEST(FindRobots, LeavesNoFolderOutWhoseDiskIsNotMounted) {
  const TwoRobots mission;
  fs::remove_all(mission.c / "scans");
  fs::create_symlink("/nowhere/scans", mission.c / "scans");
  mission.expect_refused(ErrorCode::kNotFound, "c/scans: a link to /nowhere/scans, where nothing is");
  fs::remove_all(mission.c);
  fs::create_symlink("/nowhere/c", mission.c);
  mission.expect_refused(ErrorCode::kNotFound, "c: a link to /nowhere/c, where nothing is\n  try: mount the disk");
  fs::remove(mission.c);
  fs::create_symlink("c", mission.c);
  mission.expect_refused(ErrorCode::kIo, "Too many levels of symbolic links\n  try: mend the link");
}

TEST(FindRobots, LeavesNothingOutThatLooksLikeARobot) {
  const TwoRobots mission;
  fs::rename(mission.c / "scans", mission.c / "Scans");
  mission.expect_refused(ErrorCode::kNotFound, "c: expected scans/ or submaps/, spelt so, found Scans/, poses.tum");
  fs::remove_all(mission.c / "Scans");
  mission.expect_refused(ErrorCode::kNotFound, "found poses.tum without either");
  mission.folder.write("c/scans", "");
  mission.expect_refused(ErrorCode::kIo, "c/scans: expected a folder, found a file of that name");
  fs::remove(mission.c / "scans");
  fs::create_symlink("gone.pcd", mission.c / "0.pcd");
  mission.expect_refused(ErrorCode::kNotFound, "c/0.pcd: a link to gone.pcd, where nothing is");
  fs::remove(mission.c / "0.pcd");
  fs::create_symlink("/nowhere/velodyne", mission.c / "velodyne");
  mission.expect_refused(ErrorCode::kNotFound, "c/velodyne: a link to /nowhere/velodyne");
}

TEST(FindRobots, TakesNoFolderOfAnotherKindForNothing) {
  const TwoRobots mission;
  fs::rename(mission.c / "scans/000000.pcd", mission.c / "000000.pcd");
  fs::remove(mission.c / "scans");
  EXPECT_TRUE(open_source(mission.c));
  expect_source_error(open_source(mission.folder.path()), ErrorCode::kNotFound, "name the robots one by one");
}

TEST(FindRobots, PassesOverWhatIsNobodys) {
  const TwoRobots mission;
  mission.folder.write("truth/a/poses.tum", one_pose());
  mission.folder.write("pictures/scans.png", "");
  mission.folder.write("scans.txt", "");
  mission.folder.write("lost+found/file", "");
  const Restricted restricted(mission.folder, "lost+found", 0);
  const auto opened = open_source(mission.folder.path());
  ASSERT_TRUE(opened) << to_string(opened.error());
  EXPECT_EQ(opened->robots.size(), 2U);
}

TEST(FindRobots, TakesAFolderOnceHoweverManyNamesLeadToIt) {
  const TwoRobots mission;
  const fs::path& folder = mission.folder.path();
  const TempFolder elsewhere;
  write_robot(elsewhere, "run");
  fs::create_directory_symlink(elsewhere.path() / "run", folder / "d");
  fs::create_directory_symlink("d", folder / "b_latest");
  fs::create_directory_symlink(elsewhere.path() / "run", folder / "e");
  fs::create_directory_symlink("c", folder / "latest");
  fs::create_directory_symlink(mission.a, folder / "A");
  const auto opened = open_source(folder);
  ASSERT_TRUE(opened) << to_string(opened.error());
  std::string names;
  for (const RobotLog& robot : opened->robots) names += robot.name;
  EXPECT_EQ(names, "acd");
  ASSERT_EQ(opened->notes.size(), 3U);
  EXPECT_EQ(opened->notes[0], "robot a: A leads to the same folder, and is passed over");
  EXPECT_EQ(opened->notes[1], "robot c: latest leads to the same folder, and is passed over");
  EXPECT_EQ(opened->notes[2], "robot d: e, b_latest lead to the same folder, and are passed over");
}

TEST(FindRobots, TakesALinkForOneThatLeadsToAnotherHoweverItIsSpelt) {
  const TempFolder elsewhere;
  write_robot(elsewhere, "run");
  for (const std::string target : {"d", "d/", "./d//", "d/."}) {
    const TwoRobots mission;
    const fs::path& folder = mission.folder.path();
    fs::create_directory_symlink(elsewhere.path() / "run", folder / "d");
    fs::create_directory_symlink(target, folder / "b_latest");
    const auto opened = open_source(folder);
    ASSERT_TRUE(opened) << to_string(opened.error());
    ASSERT_EQ(opened->notes.size(), 1U);
    EXPECT_EQ(opened->notes[0], "robot d: b_latest leads to the same folder, and is passed over") << target;
  }
}

TEST(FindRobots, PrefersALinkThatLeadsToTheFolderItself) {
  const TempFolder elsewhere;
  write_robot(elsewhere, "run");
  fs::create_directory_symlink("run", elsewhere.path() / "latest");
  const TwoRobots mission;
  fs::create_directory_symlink(elsewhere.path() / "latest", mission.folder.path() / "b");
  fs::create_directory_symlink(elsewhere.path() / "run", mission.folder.path() / "d");
  const auto opened = open_source(mission.folder.path());
  ASSERT_TRUE(opened) << to_string(opened.error());
  ASSERT_EQ(opened->notes.size(), 1U);
  EXPECT_EQ(opened->notes[0], "robot d: b leads to the same folder, and is passed over");
}

TEST(FindRobots, LeavesNoRobotOutWhoseNameIsALinkToAHiddenFolder) {
  const TwoRobots mission;
  fs::rename(mission.c, mission.folder.path() / ".c-second-try");
  fs::create_directory_symlink(".c-second-try", mission.c);
  const auto opened = open_source(mission.folder.path());
  ASSERT_TRUE(opened) << to_string(opened.error());
  EXPECT_EQ(opened->robots.size(), 2U);
}

TEST(FindRobots, TellsHowAMissionIsNamed) {
  const TwoRobots mission;
  const std::string path = mission.folder.path().string();
  const auto refused = open_mission({"x=" + path});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kNotFound);
  EXPECT_EQ(refused.error().message, "a mission, where NAME= expects one robot");
  EXPECT_NE(refused.error().hint.find("its robots are a, c: x="), std::string::npos) << refused.error().hint;
  // What the words alone tell comes before what lies on the disk.
  expect_source_error(open_mission({"x=" + path, "x=" + path}), ErrorCode::kUsage, "robot \"x\" is given twice");
}

TEST(FindRobots, TellsWhyPosesCannotBeRead) {
  const TwoRobots mission;
  fs::remove(mission.c / "poses.tum");
  fs::create_symlink("poses.tum", mission.c / "poses.tum");
  mission.expect_refused(ErrorCode::kIo, "poses.tum: cannot be read: Too many levels of symbolic links");
  mission.folder.write("c/poses.txt", one_pose());
  mission.expect_refused(ErrorCode::kUnsupported, "found 2: poses.tum, poses.txt");
}

}  // namespace
}  // namespace kilter
