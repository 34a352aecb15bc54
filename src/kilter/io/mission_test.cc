// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/mission.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <array>
#include <numbers>
#include <string>
#include <thread>

#include "kilter/io/cloud_file.h"
#include "testing/cloud_bytes.h"
#include "testing/octree_bytes.h"
#include "testing/temp_folder.h"

namespace kilter {
namespace {

using kilter_testing::PcdBytes;
using kilter_testing::TempFolder;
namespace fs = std::filesystem;

// Pose i stands at (i, 0, 0).
std::string poses(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += fmt::format("{} {} 0 0 0 0 0 1\n", i, i);
  return text;
}

// A scan whose one point tells which it is.
std::string scan(int index) {
  return PcdBytes{.width = "1", .points = "1", .body = fmt::format("{} 0 0\n", index)}.str();
}

void write_robot(const TempFolder& folder, const std::string& name, int scans) {
  folder.write(name + "/poses.tum", poses(scans));
  for (int i = 0; i < scans; ++i) folder.write(fmt::format("{}/scans/{:06}.pcd", name, i), scan(i));
}

void expect_error(const Expected<Mission>& mission, ErrorCode code, const std::string& message_part) {
  ASSERT_FALSE(mission) << message_part;
  EXPECT_EQ(error_code_name(mission.error().code), error_code_name(code)) << to_string(mission.error());
  EXPECT_NE(to_string(mission.error()).find(message_part), std::string::npos) << to_string(mission.error());
}

Expected<Mission> open(const TempFolder& folder, const MissionOptions& options = {}) {
  return open_mission({folder.path().string()}, options);
}

std::vector<std::string> names_of(const Expected<Mission>& mission) {
  std::vector<std::string> names;
  if (!mission) ADD_FAILURE() << to_string(mission.error());
  if (mission) {
    for (const RobotLog& robot : mission->robots) names.push_back(robot.name);
  }
  return names;
}

TEST(OpenMission, FindsRobotsInAFolderAndSortsThemBytewise) {
  const TempFolder folder;
  for (const char* name : {"b", "a", "B", "a.2"}) write_robot(folder, name, 2);
  folder.write("truth/a/poses.tum", poses(2));
  folder.write("notes.txt", "");
  folder.write(".hidden/scans/0.pcd", scan(0));
  const auto mission = open(folder);
  EXPECT_EQ(names_of(mission), (std::vector<std::string>{"B", "a", "a.2", "b"}));
  EXPECT_TRUE(mission->notes.empty());
}

TEST(OpenMission, PairsEachScanWithItsPose) {
  const TempFolder folder;
  write_robot(folder, "a", 3);
  const auto mission = open(folder);
  ASSERT_TRUE(mission);
  const RobotLog& robot = mission->robots.front();
  EXPECT_FALSE(robot.finished_submaps);
  ASSERT_EQ(robot.T_world_cloud.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(robot.T_world_cloud[i].translation_m().x(), static_cast<double>(i));
    EXPECT_EQ(robot.read_cloud(i).value().points_m.at(0).x(), static_cast<float>(i));
  }
  EXPECT_EQ(robot.cloud_name(2), (folder.path() / "a/scans/000002.pcd").string());
}

TEST(OpenMission, TellsToNameTheFilesOfAFolderOneByOne) {
  const TempFolder folder;
  folder.write("maps/a.ot", "");
  folder.write("maps/b.bt", "");
  expect_error(open_mission({(folder.path() / "maps").string()}), ErrorCode::kEmptyInput,
               "maps/a.ot, " + (folder.path() / "maps/b.bt").string());
}

TEST(OpenMission, NamesTwoFormatsInAFolderWithoutPoses) {
  const TempFolder folder;
  folder.write("maps/a.pcd", scan(0));
  folder.write("maps/b.ply", "");
  expect_error(open_mission({(folder.path() / "maps").string()}), ErrorCode::kUnsupported, "found a.pcd and b.ply");
}

TEST(OpenMission, ReadsCloudsFromSeveralThreads) {
  const TempFolder folder;
  write_robot(folder, "a", 20);
  const auto mission = open(folder);
  ASSERT_TRUE(mission);
  std::array<int, 4> right{};
  {
    std::vector<std::jthread> threads;
    for (std::size_t t = 0; t < right.size(); ++t) {
      threads.emplace_back([&, t] {
        for (std::size_t i = 0; i < 20; ++i) {
          const auto cloud = mission->robots[0].read_cloud(i);
          if (cloud && cloud->points_m.at(0).x() == static_cast<float>(i)) ++right[t];
        }
      });
    }
  }
  EXPECT_EQ(right, (std::array<int, 4>{20, 20, 20, 20}));
}

TEST(OpenMission, TakesARobotsFolderUnderItsOwnOrAnotherName) {
  const TempFolder folder;
  write_robot(folder, "a", 1);
  const std::string path = (folder.path() / "a").string();
  EXPECT_EQ(names_of(open_mission({path})), std::vector<std::string>{"a"});
  EXPECT_EQ(names_of(open_mission({path + "/"})), std::vector<std::string>{"a"});
  EXPECT_EQ(names_of(open_mission({path + "/."})), std::vector<std::string>{"a"});
  EXPECT_EQ(names_of(open_mission({"q=" + path, "p=" + path})), (std::vector<std::string>{"p", "q"}));
}

TEST(OpenMission, TakesAnEqualsSignBehindASlashAsPartOfThePath) {
  const TempFolder folder;
  write_robot(folder, "x=1", 1);
  EXPECT_EQ(names_of(open_mission({(folder.path() / "x=1").string()})), std::vector<std::string>{"x=1"});
}

TEST(OpenMission, RefusesNamesGivenTwiceOrUnfitForKeys) {
  const TempFolder folder;
  write_robot(folder, "a", 1);
  const std::string path = (folder.path() / "a").string();
  expect_error(open_mission({folder.path().string(), path}), ErrorCode::kUsage, "robot \"a\" is given twice");
  expect_error(open_mission({"=" + path}), ErrorCode::kUsage, "it is empty");
  expect_error(open_mission({"a,b=" + path}), ErrorCode::kUsage, "comma");
  expect_error(open_mission({"..=" + path}), ErrorCode::kUsage, "stands for a folder");
  expect_error(open_mission({"a\x1B=" + path}), ErrorCode::kUsage, "\"a?\" cannot be a robot's name: it holds control");
  expect_error(open_mission({"\xFF=" + path}), ErrorCode::kUsage, "not UTF-8");
  expect_error(open_mission({}), ErrorCode::kUsage, "no source given");
  expect_error(open_mission({""}), ErrorCode::kUsage, "source \"\": expected a path, found none");
  expect_error(open_mission({"a="}), ErrorCode::kUsage, "source \"a=\": expected a path, found none");
  write_robot(folder, "a,b", 1);
  expect_error(open(folder), ErrorCode::kUnsupported, "comma");
}

TEST(OpenMission, SaysWhatASourceIsNot) {
  const TempFolder folder;
  const std::string path = folder.path().string();
  expect_error(open_mission({path}), ErrorCode::kEmptyInput, "no robot");
  write_robot(folder, "day/mission/a", 1);
  expect_error(open_mission({path + "/day"}), ErrorCode::kEmptyInput,
               "further down there are robots, in " + path + "/day/mission");
  expect_error(open_mission({path + "/none"}), ErrorCode::kNotFound, "no such file or folder");
  expect_error(open_mission({"a=" + path + "/none"}), ErrorCode::kNotFound, "written ./a=");
  expect_error(open_mission({"a=" + path}), ErrorCode::kNotFound, "expected scans/ or submaps/");
  expect_error(open_mission({folder.write("a.txt", "").string()}), ErrorCode::kUnsupported, "found another file");
}

TEST(OpenMission, SaysThatCloudsLackPoses) {
  const TempFolder folder;
  const std::string path = folder.write("velodyne/000000.pcd", scan(0)).parent_path().string();
  expect_error(open_mission({path}), ErrorCode::kNotFound, "1 cloud in it (000000.pcd), but no list of poses beside");
  expect_error(open_mission({"a=" + path}), ErrorCode::kNotFound, "or name the folder above");
}

TEST(OpenMission, TakesALinkAndWhatItLeadsToForOneRobot) {
  const TempFolder folder;
  write_robot(folder, "results/today", 1);
  write_robot(folder, "elsewhere", 1);
  fs::create_directory_symlink("today", folder.path() / "results/latest");
  fs::create_directory_symlink("../elsewhere", folder.path() / "results/other");
  EXPECT_EQ(names_of(open_mission({(folder.path() / "results").string()})),
            (std::vector<std::string>{"other", "today"}));
}

TEST(OpenMission, SaysWhatToConvertForeignFilesWith) {
  const TempFolder folder;
  expect_error(open_mission({folder.write("a.LAZ", "").string()}), ErrorCode::kUnsupported, "laszip");
  expect_error(open_mission({folder.write("a.e57", "").string()}), ErrorCode::kUnsupported, "E57");
  expect_error(open_mission({"b=" + folder.write("a.pbstream", "").string()}), ErrorCode::kUnsupported, "Cartographer");
}

TEST(OpenMission, TellsWhatEachSourceIs) {
  const TempFolder folder;
  write_robot(folder, "m/a", 2);
  write_robot(folder, "m/b", 3);
  write_robot(folder, "c", 1);
  const auto mission = open_mission({(folder.path() / "m").string(), (folder.path() / "c").string()});
  ASSERT_TRUE(mission) << to_string(mission.error());
  ASSERT_EQ(mission->sources.size(), 2U);
  EXPECT_EQ(describe(mission->sources[0]), "mission, 5 scans, 2 robots");
  EXPECT_EQ(describe(mission->sources[1]), "mission, 1 scan, 1 robot");
  EXPECT_EQ(mission->robots[0].kind, "robot folder");
  EXPECT_EQ(mission->robots[0].clouds_found, 2U);
}

TEST(OpenMission, NamesBothCountsAndTheFirstMissingOne) {
  const TempFolder folder;
  write_robot(folder, "a", 3);
  folder.write("a/poses.tum", poses(2));
  expect_error(open(folder), ErrorCode::kCountMismatch,
               "2 poses in poses.tum, but 3 files in scans; 000002.pcd is the first without a pose");
  folder.write("a/poses.tum", poses(5));
  expect_error(open(folder), ErrorCode::kCountMismatch,
               "5 poses in poses.tum, but 3 files in scans; pose 3 (the first being 0) is the first without a file");
  folder.write("a/scans/000004.pcd", scan(4));
  expect_error(open(folder), ErrorCode::kCountMismatch, "the first missing one lies between 000002.pcd and 000004.pcd");
}

TEST(OpenMission, WantsExactlyOneFileOfPoses) {
  const TempFolder folder;
  folder.write("a/scans/0.pcd", scan(0));
  folder.write("a/poses/tum", poses(1));
  expect_error(open(folder), ErrorCode::kNotFound, "expected a file poses.*, found none");
  folder.write("a/poses.txt", poses(1));
  EXPECT_TRUE(open(folder));
  folder.write("a/poses.tum", poses(1));
  expect_error(open(folder), ErrorCode::kUnsupported, "found 2: poses.tum, poses.txt");
}

TEST(OpenMission, PassesOnWhatIsWrongWithPosesAndScans) {
  const TempFolder folder;
  write_robot(folder, "a", 1);
  folder.write("a/poses.tum", "");
  expect_error(open(folder), ErrorCode::kEmptyInput, "holds no pose");
  folder.write("a/poses.tum", "0 0 0 0 0 0 0 nan\n");
  expect_error(open(folder), ErrorCode::kInvalidPose, "poses.tum:1");
  folder.write("a/poses.tum", poses(1));
  folder.write("a/scans/000000.pcd", scan(0).substr(0, 100));
  const auto cloud = open(folder).value().robots[0].read_cloud(0);
  ASSERT_FALSE(cloud);
  EXPECT_EQ(cloud.error().code, ErrorCode::kTruncated);
  EXPECT_EQ(cloud.error().where, (folder.path() / "a/scans/000000.pcd").string());
}

TEST(OpenMission, ListsScansByExtensionAndNotesTheRest) {
  const TempFolder folder;
  folder.write("a/poses.tum", poses(2));
  folder.write("a/scans/0.PCD", scan(0));
  fs::create_symlink("0.PCD", folder.path() / "a/scans/1.pcd");
  folder.write("a/scans/.DS_Store", "");
  folder.write("a/scans/readme.txt", "");
  fs::create_directory(folder.path() / "a/scans/old");
  const auto mission = open(folder);
  ASSERT_TRUE(mission) << to_string(mission.error());
  EXPECT_EQ(mission->notes, std::vector<std::string>{"robot a: 2 entries of scans/ were ignored: old, readme.txt"});
  EXPECT_TRUE(mission->robots[0].read_cloud(1));
  fs::remove(folder.path() / "a/scans/readme.txt");
  EXPECT_EQ(open(folder)->notes, std::vector<std::string>{"robot a: one entry of scans/ was ignored: old"});
}

TEST(OpenMission, NotesNumbersThatSortBytewiseOutOfOrder) {
  const TempFolder folder;
  folder.write("a/poses.tum", poses(3));
  for (const int i : {1, 2, 10}) folder.write(fmt::format("a/scans/{}.pcd", i), scan(i));
  const auto mission = open(folder);
  ASSERT_TRUE(mission);
  ASSERT_EQ(mission->notes.size(), 1U);
  EXPECT_NE(mission->notes[0].find("10.pcd comes before 2.pcd"), std::string::npos);
}

TEST(OpenMission, RefusesScansThatWouldShiftOrMixTheOthers) {
  const TempFolder folder;
  folder.write("a/poses.tum", poses(1));
  fs::create_directories(folder.path() / "a/scans");
  expect_error(open(folder), ErrorCode::kEmptyInput, "no .bin, .pcd, .ply or .las file");
  folder.write("a/scans/0.laz", "");
  expect_error(open(folder), ErrorCode::kEmptyInput, "no .bin, .pcd, .ply or .las file, only 0.laz");
  folder.write("a/scans/0.pcd", scan(0));
  EXPECT_TRUE(open(folder));
  folder.write("a/scans/1.ply", "");
  expect_error(open(folder), ErrorCode::kUnsupported,
               "one folder holds one format, found 0.pcd and 1.ply\n  try: move");
  fs::remove(folder.path() / "a/scans/1.ply");
  fs::create_symlink("gone.pcd", folder.path() / "a/scans/1.pcd");
  expect_error(open(folder), ErrorCode::kNotFound,
               "1.pcd: a link to gone.pcd, where nothing is\n  try: mount the disk");
  fs::remove(folder.path() / "a/scans/1.pcd");
  ASSERT_EQ(::mkfifo((folder.path() / "a/scans/2.pcd").c_str(), 0600), 0);
  expect_error(open(folder), ErrorCode::kIo,
               "2.pcd: expected a file, found a pipe of that name\n  try: give it another");
}

TEST(OpenMission, ReadsFinishedSubmaps) {
  const TempFolder folder;
  folder.write("a/poses.tum", poses(1));
  folder.write("a/submaps/0.ply", kilter_testing::ply_bytes("ascii", "1 2 3\n4 5 6\n"));
  folder.write("a/submaps/raw.bin", "");
  const auto mission = open(folder);
  ASSERT_TRUE(mission) << to_string(mission.error());
  EXPECT_TRUE(mission->robots[0].finished_submaps);
  EXPECT_EQ(mission->robots[0].read_cloud(0).value().points_m.size(), 2U);
  EXPECT_EQ(mission->notes.size(), 1U);
  folder.write("a/submaps/1.bt", "");
  expect_error(open(folder), ErrorCode::kUnsupported, "one folder holds one format, found 0.ply and 1.bt");
  fs::create_directory(folder.path() / "a/scans");
  expect_error(open(folder), ErrorCode::kUnsupported, "both scans/ and submaps/, expected one of them\n  try: move");
}

TEST(OpenMission, ReadsTreesAsFinishedSubmapsWithTheirCells) {
  const TempFolder folder;
  folder.write("a/poses.tum", poses(2));
  folder.write("a/submaps/0.ot", kilter_testing::full_octree().str());
  folder.write("a/submaps/1.bt", kilter_testing::binary_octree().str());
  const auto mission = open(folder);
  ASSERT_TRUE(mission) << to_string(mission.error());
  const RobotLog& robot = mission->robots[0];
  EXPECT_TRUE(robot.finished_submaps);
  EXPECT_EQ(robot.cell_size_m, 0.1);
  EXPECT_EQ(robot.read_cells(0).value().cells.size(), 2U);
  EXPECT_EQ(robot.read_cells(1).value().cells.size(), 4U);
  EXPECT_EQ(robot.read_cloud(0).value().points_m.size(), 1U);
  EXPECT_NE(robot.cloud_name(1).find("1.bt"), std::string::npos);
  EXPECT_NE(notes_on_cells(*mission, 0.1).at(0).find("good to about 0.041 m"), std::string::npos);
  folder.write("a/submaps/0.ot", "");
  expect_error(open(folder), ErrorCode::kTruncated, "0.ot");
}

TEST(OpenMission, TakesATreeAsOneSubmapAtTheIdentity) {
  const TempFolder folder;
  const std::string file = folder.write("garage.ot", kilter_testing::full_octree().str()).string();
  const auto mission = open_mission({file, "b=" + file});
  ASSERT_TRUE(mission) << to_string(mission.error());
  EXPECT_EQ(names_of(mission), (std::vector<std::string>{"b", "garage"}));
  EXPECT_EQ(describe(mission->sources[0]), "OctoMap tree, 1 submap, 1 robot");
  EXPECT_EQ(mission->robots[0].T_world_cloud.at(0).translation_m(), Eigen::Vector3d::Zero());
  EXPECT_EQ(mission->robots[0].read_cells(0).value().cells.size(), 2U);
}

TEST(OpenMission, TakesPosesFromElsewhere) {
  const TempFolder folder;
  write_robot(folder, "m/a", 2);
  write_robot(folder, "m/b", 2);
  fs::remove(folder.path() / "m/a/poses.tum");
  folder.write("truth/a/poses.txt", "0 7 0 0 0 0 0 1\n1 8 0 0 0 0 0 1\n");
  const MissionOptions options = {.poses_folder = folder.path() / "truth", .T_body_sensor = {}};
  const std::vector<std::string> source = {(folder.path() / "m").string()};
  expect_error(open_mission(source, options), ErrorCode::kNotFound, "expected b/poses.* in it, found no b");
  folder.write("truth/b/poses.txt", poses(1));
  expect_error(open_mission(source, options), ErrorCode::kCountMismatch, "1 poses in poses.txt, but 2 files");
  folder.write("truth/b/poses.txt", poses(2));
  const auto mission = open_mission(source, options);
  ASSERT_TRUE(mission) << to_string(mission.error());
  EXPECT_EQ(mission->robots[0].T_world_cloud[1].translation_m().x(), 8.0);
}

TEST(OpenMission, MovesBodyPosesToTheSensor) {
  const TempFolder folder;
  write_robot(folder, "a", 2);
  write_robot(folder, "b", 2);
  const Pose3 up = Pose3::from_translation(0, 0, 2);
  const Pose3 turned(Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ())),
                     Eigen::Vector3d(0.5, 0, 0));
  MissionOptions options;
  options.T_body_sensor = {{"", up}, {"b", turned}};
  const auto mission = open(folder, options);
  ASSERT_TRUE(mission);
  EXPECT_EQ(mission->robots[0].T_world_cloud[1].translation_m(), Eigen::Vector3d(1, 0, 2));
  EXPECT_EQ(mission->robots[1].T_world_cloud[1].translation_m(), Eigen::Vector3d(1.5, 0, 0));
  EXPECT_NEAR(mission->robots[1].T_world_cloud[0].angle_rad(), std::numbers::pi / 2, 1e-12);
  options.T_body_sensor = {{"c", up}};
  expect_error(open(folder, options), ErrorCode::kConfig, "no robot has that name");
}

TEST(OpenMission, LeavesFinishedSubmapsWhereTheyAre) {
  const TempFolder folder;
  folder.write("a/poses.tum", poses(1));
  folder.write("a/submaps/0.pcd", scan(0));
  MissionOptions options;
  options.T_body_sensor = {{"", Pose3::from_translation(0, 0, 2)}};
  const auto mission = open(folder, options);
  ASSERT_TRUE(mission);
  EXPECT_EQ(mission->robots[0].T_world_cloud[0].translation_m().z(), 0.0);
  EXPECT_EQ(mission->notes.size(), 1U);
}

TEST(ReadCloudFile, GoesByTheExtension) {
  const TempFolder folder;
  std::string bin;
  kilter_testing::put_all<float>(bin, std::endian::little, 1, 2, 3, 0);
  EXPECT_EQ(read_cloud_file(folder.write("a.BIN", bin)).value().points_m.size(), 1U);
  EXPECT_EQ(read_cloud_file(folder.write("a.pcd", scan(0))).value().points_m.size(), 1U);
  EXPECT_EQ(read_cloud_file(folder.write("a.ply", scan(0))).error().code, ErrorCode::kParse);
  EXPECT_EQ(read_cloud_file(folder.write("a.laz", "")).error().code, ErrorCode::kUnsupported);
  EXPECT_EQ(read_cloud_file(folder.write("pcd", "")).error().code, ErrorCode::kUnsupported);
  EXPECT_EQ(read_cloud_file(folder.path() / "none.pcd").error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace kilter
