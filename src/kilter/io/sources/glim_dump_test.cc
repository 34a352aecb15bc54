// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/sources/glim_dump.h"

#include <limits>

#include "testing/source_folder.h"

namespace kilter {
namespace {

using namespace kilter_testing;  // a fixture's words
namespace fs = std::filesystem;

std::string graph_text(int submaps) {
  return fmt::format("num_submaps: {}\nnum_all_frames: 30\nnum_matching_cost_factors: 1\nmatching_cost vgicp 0 1\n",
                     submaps);
}

// A submap's data.txt as GLIM writes it, with two frames.
std::string data_text(int id, const Pose3& T_world_origin) {
  std::string text = fmt::format("id: {}\nT_world_origin: \n{}", id, matrix_rows(T_world_origin));
  text += "T_origin_endpoint_L: \n" + matrix_rows(pose_number(7)) + "T_origin_endpoint_R: \n" +
          matrix_rows(pose_number(8)) + "T_lidar_imu: \n" + matrix_rows(pose_number(9)) +
          "imu_bias: 0 0 0 0 0 0\nframe_id: 1\nnum_frames: 2\n";
  for (int frame = 0; frame < 2; ++frame) {
    text +=
        fmt::format("frame_{}\nid: {}\nstamp: {}.500000000\nT_odom_lidar: \n{}T_world_lidar: \n{}v_world_imu: 0 0 0\n",
                    frame, frame, 100 * id + frame, matrix_rows(pose_number(3)), matrix_rows(pose_number(4)));
  }
  return text;
}

std::string compact_points(int id) {
  std::string bytes;
  put_all<float>(bytes, std::endian::little, id + 1, 2, 3, -1, -2, -3);
  return bytes;
}

void write_dump(const TempFolder& folder, int submaps) {
  folder.write("dump/graph.txt", graph_text(submaps));
  folder.write("dump/traj_lidar.txt", "0 0 0 0 0 0 0 1\n");
  folder.write("dump/graph.bin", "binary");
  for (int i = 0; i < submaps; ++i) {
    folder.write(fmt::format("dump/{:06}/data.txt", i), data_text(i, pose_number(i)));
    folder.write(fmt::format("dump/{:06}/points_compact.bin", i), compact_points(i));
    folder.write(fmt::format("dump/{:06}/covs_compact.bin", i), "other bytes");
  }
}

TEST(GlimDump, ReadsSubmapsAsTheyAre) {
  const TempFolder folder;
  write_dump(folder, 3);
  const auto mission = open_source(folder.path() / "dump");
  const RobotLog log = only_robot(mission, "GLIM dump");
  ASSERT_EQ(log.T_world_cloud.size(), 3U);
  EXPECT_EQ(describe(mission->sources[0]), "GLIM dump, 3 submaps, 1 robot");
  EXPECT_TRUE(log.finished_submaps);
  EXPECT_EQ(log.name, "dump");
  EXPECT_EQ(log.peek_cloud(2)->points, 2U);
  EXPECT_FALSE(log.peek_cloud(2)->is_cut_short);
  EXPECT_EQ(log.stamps_ns, (std::vector<std::int64_t>{500'000'000, 100'500'000'000, 200'500'000'000}));
  EXPECT_EQ(log.clouds_found, 3U);
  EXPECT_EQ(log.poses_found, 3U);
  for (int i = 0; i < 3; ++i) {
    const auto index = static_cast<std::size_t>(i);
    EXPECT_LT(difference(log.T_world_cloud[index], pose_number(i)), 1e-12);
    EXPECT_EQ(first_point(log, index), Eigen::Vector3f(static_cast<float>(i + 1), 2, 3));
    EXPECT_EQ(log.read_cloud(index)->points_m.size(), 2U);
  }
  EXPECT_EQ(log.cloud_name(2), (folder.path() / "dump/000002/points_compact.bin").string());
  EXPECT_EQ(notes_of(mission), "");
}

TEST(GlimDump, ReadsPointsInDoublePrecisionToo) {
  std::string bytes;
  put_all<double>(bytes, std::endian::little, 1, 2, 3, 1, std::numeric_limits<double>::quiet_NaN(), 0, 0, 1);
  const auto cloud = read_glim_points(bytes, false, "points.bin");
  ASSERT_TRUE(cloud) << to_string(cloud.error());
  ASSERT_EQ(cloud->points_m.size(), 1U);
  EXPECT_EQ(cloud->points_m[0], Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(cloud->dropped_nonfinite, 1U);
  const TempFolder folder;
  write_dump(folder, 1);
  fs::remove(folder.path() / "dump/000000/points_compact.bin");
  folder.write("dump/000000/points.bin", bytes);
  EXPECT_EQ(first_point(only_robot(open_source(folder.path() / "dump"), "GLIM dump"), 0), Eigen::Vector3f(1, 2, 3));
}

TEST(GlimDump, SortsByNumberAndTellsWhatIsMissing) {
  const TempFolder folder;
  write_dump(folder, 2);
  folder.write("dump/1000000/data.txt", data_text(9, pose_number(9)));
  folder.write("dump/1000000/points_compact.bin", compact_points(9));
  folder.write("dump/000001/notes", "");
  folder.write("dump/config/config.json", "{}");
  const auto mission = open_source(folder.path() / "dump");
  const RobotLog log = only_robot(mission, "GLIM dump");
  ASSERT_EQ(log.T_world_cloud.size(), 3U);
  EXPECT_EQ(first_point(log, 2).x(), 10.0F);
  EXPECT_NE(notes_of(mission).find("graph.txt names 2 submaps, 3 are there"), std::string::npos) << notes_of(mission);
}

TEST(GlimDump, TellsWhenSixDigitsAreCoarse) {
  const TempFolder folder;
  write_dump(folder, 1);
  folder.write("dump/000000/data.txt", data_text(0, Pose3::from_translation(2345.67, 0, 0)));
  EXPECT_NE(notes_of(open_source(folder.path() / "dump")).find("six digits of data.txt are 1 cm apart"),
            std::string::npos);
}

TEST(GlimDump, SaysWhichFileIsWrongAndWhere) {
  const TempFolder folder;
  write_dump(folder, 2);
  const fs::path dump = folder.path() / "dump";
  folder.write("dump/000001/data.txt", "id: 1\nT_world_origin: \n1 0 0 0\n0 1 0 0\n");
  expect_source_error(open_source(dump), ErrorCode::kTruncated, "000001/data.txt:4: T_world_origin: expected 4 rows");
  folder.write("dump/000001/data.txt", "id: 1\r\nT_world_origin: \r\n1 0 0 0\r\n0 nan 0 0\r\n");
  expect_source_error(open_source(dump), ErrorCode::kInvalidPose, "000001/data.txt:4: T_world_origin: column 2 is nan");
  folder.write("dump/000001/data.txt", "id: 1\n");
  expect_source_error(open_source(dump), ErrorCode::kParse, "000001/data.txt: expected a line `T_world_origin:`");
  folder.write("dump/000001/data.txt", data_text(1, Pose3()));
  fs::remove(dump / "000001/points_compact.bin");
  expect_source_error(open_source(dump), ErrorCode::kNotFound, "expected points_compact.bin (or points.bin)");
  folder.write("dump/000001/points_compact.bin", "thirteen byte");
  EXPECT_TRUE(only_robot(open_source(dump), "GLIM dump").peek_cloud(1)->is_cut_short);
  const auto cloud = only_robot(open_source(dump), "GLIM dump").read_cloud(1);
  ASSERT_FALSE(cloud);
  EXPECT_EQ(cloud.error().code, ErrorCode::kTruncated);
  EXPECT_EQ(cloud.error().message, "13 bytes are 1 points of 12 bytes and 1 bytes more");
  EXPECT_EQ(read_glim_points("", true, "p").error().code, ErrorCode::kTruncated);
}

TEST(GlimDump, IsNoOtherFolder) {
  const TempFolder folder;
  folder.write("a/graph.txt", "something else\n");
  folder.write("a/000000/data.txt", "");
  folder.write("b/graph.txt", graph_text(0));
  EXPECT_FALSE(is_glim_dump(folder.path() / "a"));
  EXPECT_FALSE(is_glim_dump(folder.path() / "b"));
  EXPECT_FALSE(is_glim_dump(folder.path() / "none"));
}

}  // namespace
}  // namespace kilter
