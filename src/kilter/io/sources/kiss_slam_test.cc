// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/sources/kiss_slam.h"

#include "testing/source_folder.h"

namespace kilter {
namespace {

using namespace kilter_testing;  // a fixture's words
namespace fs = std::filesystem;

// KISS-SLAM moves a local map's points into the world before it writes them.
std::string world_ply(const Pose3& T_world_submap, int i) {
  const Eigen::Vector3d first = T_world_submap * Eigen::Vector3d(i + 1, 2, 3);
  const Eigen::Vector3d second = T_world_submap * Eigen::Vector3d(-1, -2, -3);
  return ply_bytes("ascii", fmt::format("{} {} {}\n{} {} {}\n", first.x(), first.y(), first.z(), second.x(), second.y(),
                                        second.z()));
}

void write_result(const TempFolder& folder, const std::string& name, int local_maps) {
  std::string graph = "FIX 0\n";
  for (int i = 0; i <= local_maps; ++i) graph += g2o_vertex(i, pose_number(i));  // the last local map is empty
  folder.write(name + "/local_maps/local_map_graph.g2o", graph + "EDGE_SE3:QUAT 0 1 0 0 0 0 0 0 1\n");
  folder.write(name + "/trajectory.g2o", "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n");
  folder.write(name + "/00_poses_kitti.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  for (int i = 0; i < local_maps; ++i) {
    folder.write(fmt::format("{}/local_maps/plys/{:06}.ply", name, i), world_ply(pose_number(i), i));
  }
}

TEST(KissSlam, ReadsLocalMapsInTheirOwnFrames) {
  const TempFolder folder;
  write_result(folder, "r", 3);
  const auto mission = open_source(folder.path() / "r");
  const RobotLog log = only_robot(mission, "KISS-SLAM result");
  ASSERT_EQ(log.T_world_cloud.size(), 3U);
  EXPECT_TRUE(log.finished_submaps);
  EXPECT_EQ(log.clouds_found, 3U);
  EXPECT_EQ(log.poses_found, 3U) << "the last local map is empty by design, which is nothing odd";
  EXPECT_EQ(notes_of(mission), "");
  for (int i = 0; i < 3; ++i) {
    const auto index = static_cast<std::size_t>(i);
    EXPECT_LT(difference(log.T_world_cloud[index], pose_number(i)), 1e-12);
    EXPECT_LT((first_point(log, index) - Eigen::Vector3f(static_cast<float>(i + 1), 2, 3)).norm(), 1e-5F);
  }
}

TEST(KissSlam, CountsVerticesWithoutAMapButTheLast) {
  const TempFolder folder;
  write_result(folder, "r", 3);
  fs::remove(folder.path() / "r/local_maps/plys/000002.ply");
  EXPECT_EQ(only_robot(open_source(folder.path() / "r"), "KISS-SLAM result").poses_found, 4U);
}

TEST(KissSlam, TakesTheLinkToTheLatestResult) {
  const TempFolder folder;
  write_result(folder, "results/2026-01-02_03-04-05", 2);
  fs::create_directory_symlink("2026-01-02_03-04-05", folder.path() / "results/latest");
  EXPECT_EQ(only_robot(open_source(folder.path() / "results/latest"), "KISS-SLAM result").name, "latest");
}

TEST(KissSlam, LeavesOutMapsWithoutAVertexAndSaysSo) {
  const TempFolder folder;
  write_result(folder, "r", 3);
  folder.write("r/local_maps/local_map_graph.g2o", g2o_vertex(1, pose_number(1)));
  const auto mission = open_source(folder.path() / "r");
  EXPECT_NEAR(first_point(only_robot(mission, "KISS-SLAM result"), 0).x(), 2.0F, 1e-5F);
  EXPECT_EQ(notes_of(mission), "robot r: poses matched 1 of 3 clouds by number; the other 2 are left out\n");
  folder.write("r/local_maps/local_map_graph.g2o", g2o_vertex(7, pose_number(1)));
  expect_source_error(open_source(folder.path() / "r"), ErrorCode::kCountMismatch,
                      "none of 3 clouds, 000000.ply to 000002.ply, has a vertex of its number; those go from 7 to 7");
}

TEST(KissSlam, SaysWhatIsWrong) {
  const TempFolder folder;
  write_result(folder, "r", 1);
  const fs::path result = folder.path() / "r";
  folder.write("r/local_maps/plys/map.ply", "");
  expect_source_error(open_source(result), ErrorCode::kUnsupported, "map.ply: expected a number as the cloud's name");
  fs::remove_all(result / "local_maps/plys");
  expect_source_error(open_source(result), ErrorCode::kNotFound, "no such folder");
  fs::create_directory(result / "local_maps/plys");
  expect_source_error(open_source(result), ErrorCode::kEmptyInput, "no cloud in it");
  folder.write("r/local_maps/local_map_graph.g2o", "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 0\n");
  expect_source_error(open_source(result), ErrorCode::kInvalidPose, "local_map_graph.g2o:1: quaternion");
}

}  // namespace
}  // namespace kilter
