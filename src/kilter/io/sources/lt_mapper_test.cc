// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/sources/lt_mapper.h"

#include "testing/source_folder.h"

namespace kilter {
namespace {

using namespace kilter_testing;  // a fixture's words
namespace fs = std::filesystem;

void write_session(const TempFolder& folder, int scans) {
  std::string poses;
  std::string graph;
  std::string times;
  for (int i = 0; i < scans; ++i) {
    poses += matrix_rows(pose_number(i), 3, " ") + "\n";
    graph += g2o_vertex(i, pose_number(i + 10));
    times += fmt::format("16276{:05}.25\n", i);
    folder.write(fmt::format("s/Scans/{:06}.pcd", i), cloud_number(i));
    folder.write(fmt::format("s/SCDs/{:06}.scd", i), "0 0\n");
  }
  folder.write("s/optimized_poses.txt", poses);
  folder.write("s/singlesession_posegraph.g2o", graph);
  folder.write("s/times.txt", times);
}

TEST(LtMapper, ReadsScansAtOptimisedPoses) {
  const TempFolder folder;
  write_session(folder, 3);
  const auto mission = open_source(folder.path() / "s");
  const RobotLog log = only_robot(mission, "LT-mapper session");
  ASSERT_EQ(log.T_world_cloud.size(), 3U);
  EXPECT_FALSE(log.finished_submaps);
  EXPECT_EQ(log.stamps_ns.at(2), 1627600002250000000);
  EXPECT_EQ(notes_of(mission), "");
  for (int i = 0; i < 3; ++i) {
    const auto index = static_cast<std::size_t>(i);
    EXPECT_LT(difference(log.T_world_cloud[index], pose_number(i)), 1e-12);
    EXPECT_EQ(first_point(log, index).x(), static_cast<float>(i + 1));
  }
}

TEST(LtMapper, TakesTheGraphWithoutOptimisedPosesAndSaysSo) {
  const TempFolder folder;
  write_session(folder, 2);
  fs::remove(folder.path() / "s/optimized_poses.txt");
  const auto mission = open_source(folder.path() / "s");
  EXPECT_LT(difference(only_robot(mission, "LT-mapper session").T_world_cloud.at(1), pose_number(11)), 1e-12);
  EXPECT_NE(notes_of(mission).find("before loops were closed"), std::string::npos) << notes_of(mission);
}

TEST(LtMapper, TellsHowManyScansHaveAPose) {
  const TempFolder folder;
  write_session(folder, 3);
  folder.write("s/Scans/000003.pcd", cloud_number(3));
  const auto mission = open_source(folder.path() / "s");
  EXPECT_EQ(only_robot(mission, "LT-mapper session").clouds_found, 4U);
  EXPECT_EQ(notes_of(mission), "robot s: poses matched 3 of 4 clouds by number; the other one is left out\n");
}

TEST(LtMapper, GoesWithoutTimesThatAreNone) {
  const TempFolder folder;
  write_session(folder, 2);
  folder.write("s/times.txt", "1627600000.5\n");
  const auto mission = open_source(folder.path() / "s");
  EXPECT_TRUE(only_robot(mission, "LT-mapper session").stamps_ns.empty());
  EXPECT_EQ(notes_of(mission), "robot s: stamps are not known: times.txt is not a list of 2 of them\n");
}

TEST(LtMapper, SaysWhatIsWrong) {
  const TempFolder folder;
  write_session(folder, 2);
  folder.write("s/optimized_poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0\n");
  expect_source_error(open_source(folder.path() / "s"), ErrorCode::kParse,
                      "optimized_poses.txt:2: expected 12 columns");
  fs::remove_all(folder.path() / "s/Scans");
  fs::create_directory(folder.path() / "s/Scans");
  expect_source_error(open_source(folder.path() / "s"), ErrorCode::kEmptyInput, "no cloud in it");
}

}  // namespace
}  // namespace kilter
