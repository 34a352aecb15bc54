// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/sources/flat_folder.h"

#include "testing/source_folder.h"

namespace kilter {
namespace {

using namespace kilter_testing;  // a fixture's words
namespace fs = std::filesystem;

constexpr std::string_view kKind = "folder of clouds";

// Poses 0, 1, ... in TUM's layout, 0.1 s apart from `start_s`.
std::string tum(int count, int start_s = 0) {
  std::string text = "# made by a test\n";
  for (int i = 0; i < count; ++i)
    text += fmt::format("{}.{} {}\n", start_s + i / 10, i % 10, tum_columns(pose_number(i)));
  return text;
}

void write_clouds(const TempFolder& folder, int count) {
  for (int i = 0; i < count; ++i) folder.write(fmt::format("f/{:06}.pcd", i), cloud_number(i));
}

// Cloud i stands at pose i.
void expect_in_order(const RobotLog& log, int count) {
  ASSERT_EQ(log.T_world_cloud.size(), static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const auto index = static_cast<std::size_t>(i);
    EXPECT_LT(difference(log.T_world_cloud[index], pose_number(i)), 1e-9) << i;
    EXPECT_EQ(first_point(log, index).x(), static_cast<float>(i + 1));
  }
}

TEST(FlatFolder, TakesAsManyPosesInOrderWhateverTheirLayout) {
  std::string kitti;
  std::string graph;
  std::string table = "stamp,qw,qx,qy,qz,x,y,z\n";
  for (int i = 0; i < 3; ++i) {
    const Pose3 T = pose_number(i);
    const Eigen::Quaterniond& q = T.rotation();
    kitti += matrix_rows(T, 3, " ") + "\n";
    graph = g2o_vertex(10 * i, T) + graph;
    table += fmt::format("{},{},{},{},{},{},{},{}\n", i, q.w(), q.x(), q.y(), q.z(), T.translation_m().x(),
                         T.translation_m().y(), T.translation_m().z());
  }
  for (const auto& [name, text] : {std::pair<std::string, std::string>{"poses.txt", tum(3)},
                                   {"kitti.txt", kitti},
                                   {"graph.g2o", graph},
                                   {"trajectory.csv", table},
                                   {"poses.whatever", "\xEF\xBB\xBF" + tum(3)}}) {
    SCOPED_TRACE(name);
    const TempFolder folder;
    write_clouds(folder, 3);
    folder.write("f/" + name, text);
    folder.write("f/README.txt", "Clouds of a test, with a list of poses.\n");
    const auto mission = open_source(folder.path() / "f");
    expect_in_order(only_robot(mission, kKind), 3);
    EXPECT_EQ(notes_of(mission), "");
  }
}

TEST(FlatFolder, SortsNumbersByThemselves) {
  const TempFolder folder;
  for (int i = 0; i < 11; ++i) folder.write(fmt::format("f/{}.pcd", i), cloud_number(i));
  folder.write("f/poses.tum", tum(11));
  expect_in_order(only_robot(open_source(folder.path() / "f"), kKind), 11);
}

TEST(FlatFolder, SortsNumbersBehindAndBeforeWordsToo) {
  for (const auto& [before, behind] : {std::pair("scan_", ""), std::pair("scan", "_points"), std::pair("", "_map2")}) {
    const TempFolder folder;
    for (int i = 0; i < 11; ++i) folder.write(fmt::format("f/{}{}{}.pcd", before, i + 5, behind), cloud_number(i));
    folder.write("f/poses.tum", tum(11));
    expect_in_order(only_robot(open_source(folder.path() / "f"), kKind), 11);
  }
}

TEST(FlatFolder, MatchesStampsAcrossUnitsAndTellsHowMany) {
  const TempFolder folder;
  folder.write("f/traj.txt", tum(4, 1403636579));
  for (int i = 0; i < 4; ++i) folder.write(fmt::format("f/14036365790{}0000000.pcd", i), cloud_number(i));
  folder.write("f/1403636600000000000.pcd", cloud_number(9));
  folder.write("f/1403636500000000000.pcd", cloud_number(9));
  const auto mission = open_source(folder.path() / "f");
  const RobotLog log = only_robot(mission, kKind);
  // Stamps end in .x00, names in .0x: clouds lie between the first two poses.
  EXPECT_EQ(log.clouds_found, 6U);
  EXPECT_EQ(log.poses_found, 4U);
  ASSERT_EQ(log.T_world_cloud.size(), 4U);
  EXPECT_EQ(log.stamps_ns.at(1), 1403636579010000000);
  EXPECT_NEAR(log.T_world_cloud.at(1).translation_m().x(), 1.1, 1e-6);
  EXPECT_EQ(notes_of(mission),
            "robot f: poses matched 4 of 6 clouds by stamp (names in ns, poses in s); the other 2 are left out\n");
}

TEST(FlatFolder, TellsOfPosesThatShareAStamp) {
  const TempFolder folder;
  std::string rounded;
  for (int i = 0; i < 4; ++i) rounded += fmt::format("170000000{} {}\n", i / 2, tum_columns(pose_number(i)));
  folder.write("f/poses.tum", rounded);
  for (int i = 0; i < 2; ++i) folder.write(fmt::format("f/170000000{}.0.pcd", i), cloud_number(i));
  const auto mission = open_source(folder.path() / "f");
  EXPECT_EQ(only_robot(mission, kKind).T_world_cloud.size(), 2U);
  EXPECT_NE(notes_of(mission).find("2 of 4 poses have the stamp of one before and are left out"), std::string::npos)
      << notes_of(mission);
}

TEST(FlatFolder, OrdersCloudsByTime) {
  const TempFolder folder;
  folder.write("f/poses.tum", tum(20, 9));
  folder.write("f/10.5.pcd", cloud_number(15));
  folder.write("f/9.5.pcd", cloud_number(5));
  const RobotLog log = only_robot(open_source(folder.path() / "f"), kKind);
  ASSERT_EQ(log.T_world_cloud.size(), 2U);
  EXPECT_EQ(first_point(log, 0).x(), 6.0F);
  EXPECT_LT(difference(log.T_world_cloud[1], pose_number(15)), 1e-9);
}

TEST(FlatFolder, TellsWhatStampsLookLikeWhenNoneMeet) {
  const TempFolder folder;
  folder.write("f/poses.tum", tum(3, 1700000000));
  folder.write("f/1403636579763555584.pcd", cloud_number(0));
  folder.write("f/1403636579863555584.pcd", cloud_number(1));
  expect_source_error(open_source(folder.path() / "f"), ErrorCode::kCountMismatch,
                      "no cloud has a pose at its time: names of 2 clouds go from 1403636579763555584 to "
                      "1403636579863555584, in ns; stamps of 3 poses from 1700000000.000 to 1700000000.200, in s");
  folder.write("f/1403636579963555584.pcd", cloud_number(2));
  const auto as_many = open_source(folder.path() / "f");
  expect_in_order(only_robot(as_many, kKind), 3);
  EXPECT_NE(notes_of(as_many).find("taken in order"), std::string::npos) << notes_of(as_many);
}

TEST(FlatFolder, MatchesNumbersWhereCountsDiffer) {
  const TempFolder folder;
  write_clouds(folder, 4);
  fs::remove(folder.path() / "f/000001.pcd");
  std::string counted;
  for (int i = 0; i < 3; ++i) counted += fmt::format("{}.000 {}\n", i, tum_columns(pose_number(i)));
  folder.write("f/poses.tum", counted + "9 0 0 0 0 0 0 1\n");
  const auto by_stamp = open_source(folder.path() / "f");
  EXPECT_NE(notes_of(by_stamp).find("poses matched 2 of 3 clouds by number"), std::string::npos) << notes_of(by_stamp);
  EXPECT_LT(difference(only_robot(by_stamp, kKind).T_world_cloud.at(1), pose_number(2)), 1e-9);
  fs::remove(folder.path() / "f/poses.tum");
  folder.write("f/graph.g2o", g2o_vertex(3, pose_number(3)));
  EXPECT_LT(difference(only_robot(open_source(folder.path() / "f"), kKind).T_world_cloud.at(0), pose_number(3)), 1e-9);
}

TEST(FlatFolder, MatchesIdsWhereOtherCloudsThanVerticesAreMissing) {
  const TempFolder folder;
  write_clouds(folder, 6);
  fs::remove(folder.path() / "f/000001.pcd");
  std::string graph;
  for (const int id : {0, 1, 2, 3, 5}) graph += g2o_vertex(id, pose_number(id));
  folder.write("f/graph.g2o", graph);
  const auto mission = open_source(folder.path() / "f");
  const RobotLog log = only_robot(mission, kKind);
  ASSERT_EQ(log.T_world_cloud.size(), 4U) << notes_of(mission);
  EXPECT_LT(difference(log.T_world_cloud[1], pose_number(2)), 1e-9);
  EXPECT_EQ(first_point(log, 1).x(), 3.0F);
  EXPECT_NE(notes_of(mission).find("poses matched 4 of 5 clouds by number"), std::string::npos) << notes_of(mission);
}

TEST(FlatFolder, FindsItsListAmongAnyNumberOfTextFiles) {
  const TempFolder folder;
  write_clouds(folder, 2);
  folder.write("f/poses.txt", tum(2));
  for (int i = 0; i < 40; ++i) {
    folder.write(fmt::format("f/a{:02}.txt", i), "labels\n");
    EXPECT_TRUE(is_flat_folder(folder.path() / "f")) << i;
  }
}

TEST(FlatFolder, HoldsPosesThatAreGivenForItAgainstItsNames) {
  const TempFolder folder;
  write_clouds(folder, 2);
  folder.write("f/poses.tum", tum(2));
  const std::string heading = "x y z qx qy qz qw file\n";
  const auto with_poses = [&](const std::string& rows) {
    folder.write("new/f/poses.txt", heading + rows);
    return open_mission({(folder.path() / "f").string()}, {.poses_folder = folder.path() / "new", .T_body_sensor = {}});
  };
  EXPECT_TRUE(with_poses("7 0 0 0 0 0 1 000000.pcd\n8 0 0 0 0 0 1 000001.pcd\n"));
  expect_source_error(with_poses("8 0 0 0 0 0 1 000001.pcd\n7 0 0 0 0 0 1 000000.pcd\n"), ErrorCode::kCountMismatch,
                      "pose 0 (the first being 0) names 000001.pcd, but cloud 0 is 000000.pcd");
}

TEST(FlatFolder, GoesByNamesOfFilesWhereATableHasThem) {
  const TempFolder folder;
  write_clouds(folder, 3);
  const std::string heading = "file,x,y,z,qx,qy,qz,qw\n";
  folder.write("f/poses.csv", heading + "/elsewhere/000002.pcd,2,0,0,0,0,0,1\n000000,7,0,0,0,0,0,1\n");
  const auto mission = open_source(folder.path() / "f");
  const RobotLog log = only_robot(mission, kKind);
  ASSERT_EQ(log.T_world_cloud.size(), 2U);
  EXPECT_EQ(log.T_world_cloud[0].translation_m().x(), 7.0);
  EXPECT_EQ(first_point(log, 1).x(), 3.0F);
  EXPECT_NE(notes_of(mission).find("poses matched 2 of 3 clouds by file name"), std::string::npos);
  folder.write("f/poses.csv", heading + "a.pcd,2,0,0,0,0,0,1\na.pcd,7,0,0,0,0,0,1\n");
  expect_source_error(open_source(folder.path() / "f"), ErrorCode::kParse, "two poses name one cloud, a.pcd");
  folder.write("f/poses.csv", heading + "a.pcd,2,0,0,0,0,0,1\n");
  expect_source_error(open_source(folder.path() / "f"), ErrorCode::kCountMismatch,
                      "it names a.pcd, but the clouds are 000000.pcd, 000001.pcd, 000002.pcd");
}

TEST(FlatFolder, RefusesOtherCountsSeveralListsAndMixedClouds) {
  const TempFolder folder;
  write_clouds(folder, 3);
  folder.write("f/kitti.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  expect_source_error(open_source(folder.path() / "f"), ErrorCode::kCountMismatch,
                      "1 poses in kitti.txt, but 3 files in f; 000001.pcd is the first without a pose");
  folder.write("f/poses.tum", tum(3));
  expect_source_error(open_source(folder.path() / "f"), ErrorCode::kUnsupported,
                      "expected one list of poses beside the clouds, found 2: kitti.txt, poses.tum");
  fs::remove(folder.path() / "f/kitti.txt");
  folder.write("f/map.ply", "");
  expect_source_error(open_source(folder.path() / "f"), ErrorCode::kUnsupported,
                      "one folder holds one format, found 000000.pcd and map.ply");
}

TEST(FlatFolder, SaysWhereAListIsWrongEvenIfItBeginsSo) {
  const TempFolder folder;
  write_clouds(folder, 2);
  folder.write("f/poses.txt", "0 0 0 0 0 0 1\n");
  expect_source_error(open_source(folder.path() / "f"), ErrorCode::kParse,
                      "poses.txt:1: expected 8 or 12 columns, found 7");
  folder.write("f/poses.txt", "t,x,y,z,roll,pitch,yaw\n");
  expect_source_error(open_source(folder.path() / "f"), ErrorCode::kParse, "poses.txt:1");
}

TEST(FlatFolder, AsksWhosePosesTheyAreBesideACalibration) {
  const TempFolder folder;
  write_clouds(folder, 1);
  folder.write("f/poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  folder.write("f/calib.txt", "Tr: 1 0 0 0 0 1 0 0 0 0 1 0\n");
  EXPECT_NE(notes_of(open_source(folder.path() / "f")).find("if they are the camera's"), std::string::npos);
}

TEST(FlatFolder, IsNoFolderOfSourcesAndNoOutput) {
  const TempFolder folder;
  write_clouds(folder, 1);
  EXPECT_FALSE(is_flat_folder(folder.path() / "f"));
  folder.write("f/poses.tum", tum(1));
  EXPECT_TRUE(is_flat_folder(folder.path() / "f"));
  folder.write("f/result.json", "{}");
  EXPECT_FALSE(is_flat_folder(folder.path() / "f"));
  fs::remove(folder.path() / "f/result.json");
  folder.write("f/robot/scans/0.pcd", cloud_number(0));
  EXPECT_FALSE(is_flat_folder(folder.path() / "f"));
}

}  // namespace
}  // namespace kilter
