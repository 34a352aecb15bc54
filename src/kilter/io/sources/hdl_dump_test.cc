// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/sources/hdl_dump.h"

#include "testing/source_folder.h"

namespace kilter {
namespace {

using namespace kilter_testing;  // a fixture's words
namespace fs = std::filesystem;

struct KeyFrameText {
  std::string stamp = "stamp 1503043136 87654\n";
  std::string estimate = "estimate\n" + matrix_rows(Pose3());
  std::string odom = "odom\n" + matrix_rows(pose_number(5));
  std::string id = "id 4\n";

  [[nodiscard]] std::string str() const {
    return stamp + estimate + odom + "accum_distance 3.5\nfloor_coeffs 0 0 1 0.4\norientation 1 0 0 0\n" + id;
  }
};

void write_dump(const TempFolder& folder, int key_frames) {
  folder.write("dump/special_nodes.csv", "anchor_node -1\nanchor_edge -1\nfloor_node -1\n");
  folder.write("dump/graph.g2o", "VERTEX_SE3:QUAT 4 9 9 9 0 0 0 1\n");
  for (int i = 0; i < key_frames; ++i) {
    folder.write(fmt::format("dump/{:06}/data", i),
                 KeyFrameText{.estimate = "estimate\n" + matrix_rows(pose_number(i))}.str());
    folder.write(fmt::format("dump/{:06}/cloud.pcd", i), cloud_number(i));
  }
}

TEST(HdlDump, ReadsKeyFramesAtTheirEstimates) {
  const TempFolder folder;
  write_dump(folder, 3);
  const auto mission = open_source(folder.path() / "dump");
  const RobotLog log = only_robot(mission, "hdl_graph_slam dump");
  ASSERT_EQ(log.T_world_cloud.size(), 3U);
  EXPECT_FALSE(log.finished_submaps);
  EXPECT_EQ(log.stamps_ns, std::vector<std::int64_t>(3, 1503043136000087654));
  for (int i = 0; i < 3; ++i) {
    const auto index = static_cast<std::size_t>(i);
    EXPECT_LT(difference(log.T_world_cloud[index], pose_number(i)), 1e-12);
    EXPECT_EQ(first_point(log, index), Eigen::Vector3f(static_cast<float>(i + 1), 2, 3));
  }
  EXPECT_EQ(notes_of(mission), "");
}

TEST(HdlDump, SaysWhichScansHaveLostTheirPose) {
  const TempFolder folder;
  write_dump(folder, 3);
  std::filesystem::remove(folder.path() / "dump/000001/data");
  const auto mission = open_source(folder.path() / "dump");
  EXPECT_EQ(only_robot(mission, "hdl_graph_slam dump").T_world_cloud.size(), 2U);
  EXPECT_NE(notes_of(mission).find("000001 has a cloud.pcd but no file `data`"), std::string::npos)
      << notes_of(mission);
}

TEST(HdlDump, TakesTheVertexWhereThereIsNoEstimate) {
  const TempFolder folder;
  write_dump(folder, 2);
  folder.write("dump/000001/data", KeyFrameText{.estimate = ""}.str());
  const auto mission = open_source(folder.path() / "dump");
  const RobotLog log = only_robot(mission, "hdl_graph_slam dump");
  EXPECT_EQ(log.T_world_cloud.at(1).translation_m(), Eigen::Vector3d(9, 9, 9));
  EXPECT_EQ(notes_of(mission), "");
}

TEST(HdlDump, TakesOdometryForAllOrNoneAndSaysSo) {
  const TempFolder folder;
  write_dump(folder, 2);
  folder.write("dump/000001/data", KeyFrameText{.estimate = "", .id = "id 5\n"}.str());
  const auto mission = open_source(folder.path() / "dump");
  const RobotLog log = only_robot(mission, "hdl_graph_slam dump");
  EXPECT_LT(difference(log.T_world_cloud.at(0), pose_number(5)), 1e-12);
  EXPECT_NE(notes_of(mission).find("000001/data has no `estimate`"), std::string::npos) << notes_of(mission);
  EXPECT_NE(notes_of(mission).find("what is judged is the odometry"), std::string::npos);
  folder.write("dump/000000/data", KeyFrameText{.odom = ""}.str());
  expect_source_error(open_source(folder.path() / "dump"), ErrorCode::kParse,
                      "000001/data: no `estimate`, and no `odom` in");
}

// A mission of robots' folders, and another program's dump among them.
TEST(HdlDump, BesideARobotsFolderIsLeftOutWithANote) {
  const TempFolder folder;
  write_dump(folder, 2);
  folder.write("a/poses.txt", "0 0 0 0 0 0 0 1\n");
  folder.write("a/scans/0.pcd", cloud_number(0));
  const auto mission = open_source(folder.path());
  ASSERT_TRUE(mission);
  ASSERT_EQ(mission->robots.size(), 1U);
  EXPECT_NE(notes_of(mission).find("beside robot a: dump is of another kind"), std::string::npos) << notes_of(mission);
}

TEST(HdlDump, SaysWhichFileIsWrongAndWhere) {
  const TempFolder folder;
  write_dump(folder, 2);
  const fs::path dump = folder.path() / "dump";
  folder.write("dump/000001/data", "stamp 1 2\nestimate\n1 0 0 0\n0 1 0 0\n0 0 1 x\n");
  expect_source_error(open_source(dump), ErrorCode::kParse,
                      "000001/data:5: estimate: column 4: expected a number, found \"x\"");
  folder.write("dump/000001/data", "estimate\n2 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  expect_source_error(open_source(dump), ErrorCode::kInvalidPose,
                      "000001/data:5: estimate: the matrix is not a rotation");
  folder.write("dump/000001/data", KeyFrameText{.estimate = ""}.str());
  folder.write("dump/graph.g2o", "VERTEX_SE3:QUAT 4 9 9 9 0 0 0\n");
  expect_source_error(open_source(dump), ErrorCode::kParse, "graph.g2o:1: column 9");
  fs::remove(dump / "000001/cloud.pcd");
  expect_source_error(open_source(dump), ErrorCode::kNotFound, "expected cloud.pcd, found none");
}

TEST(HdlDump, GoesWithoutStampsThatAreNone) {
  const TempFolder folder;
  write_dump(folder, 1);
  for (const char* stamp : {"", "stamp -1 0\n", "stamp 1 1000000000\n", "stamp 1\n", "stamp 99999999999 0\n"}) {
    folder.write("dump/000000/data", "\xEF\xBB\xBF" + KeyFrameText{.stamp = stamp}.str());
    EXPECT_TRUE(only_robot(open_source(folder.path() / "dump"), "hdl_graph_slam dump").stamps_ns.empty()) << stamp;
  }
}

}  // namespace
}  // namespace kilter
