// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/sources/kitti_sequence.h"

#include "testing/source_folder.h"

namespace kilter {
namespace {

using namespace kilter_testing;  // a fixture's words
namespace fs = std::filesystem;

// The camera looks along the velodyne's x; its y points down.
Pose3 camera_velodyne() {
  Eigen::Matrix3d R;
  R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  return {Eigen::Quaterniond(R), Eigen::Vector3d(0.01, -0.07, -0.27)};
}

std::string calibration() {
  return "P0: 718 0 607 0 0 718 185 0 0 0 1 0\r\nTr: " + matrix_rows(camera_velodyne(), 3, " ") + "\r\n";
}

std::string bin(int i) {
  std::string bytes;
  put_all<float>(bytes, std::endian::little, i + 1, 2, 3, 0.5);
  return bytes;
}

// The lidar's pose i as the camera's: T_cam0_cam = Tr * T_velo0_velo * Tr^-1.
std::string camera_poses(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) {
    text += matrix_rows(camera_velodyne() * pose_number(i) * camera_velodyne().inverse(), 3, " ") + "\n";
  }
  return text;
}

void write_sequence(const TempFolder& folder, int scans) {
  folder.write("sequences/04/calib.txt", calibration());
  folder.write("sequences/04/times.txt", "0.000000e+00\n1.036224e-01\n2.072448e-01\n");
  folder.write("poses/04.txt", camera_poses(3));
  for (int i = 0; i < scans; ++i) folder.write(fmt::format("sequences/04/velodyne/{:06}.bin", i), bin(i));
}

TEST(KittiSequence, TurnsTheCamerasPosesIntoTheLidars) {
  const TempFolder folder;
  write_sequence(folder, 3);
  const auto mission = open_source(folder.path() / "sequences/04");
  const RobotLog log = only_robot(mission, "KITTI sequence");
  ASSERT_EQ(log.T_world_cloud.size(), 3U);
  EXPECT_EQ(log.stamps_ns.at(0), 0);
  EXPECT_NEAR(static_cast<double>(log.stamps_ns.at(1)), 103'622'400, 1);
  EXPECT_EQ(notes_of(mission), "");
  for (int i = 0; i < 3; ++i) {
    const auto index = static_cast<std::size_t>(i);
    EXPECT_LT(difference(log.T_world_cloud[index], pose_number(i)), 1e-9);
    EXPECT_EQ(first_point(log, index), Eigen::Vector3f(static_cast<float>(i + 1), 2, 3));
  }
}

TEST(KittiSequence, PrefersItsOwnPosesAndGoesByTheScansNumbers) {
  const TempFolder folder;
  write_sequence(folder, 2);
  fs::remove(folder.path() / "sequences/04/velodyne/000000.bin");
  folder.write("sequences/04/velodyne/000007.bin", bin(7));
  folder.write("sequences/04/poses.txt", camera_poses(2));
  const auto mission = open_source(folder.path() / "sequences/04/.");
  const RobotLog log = only_robot(mission, "KITTI sequence");
  ASSERT_EQ(log.T_world_cloud.size(), 1U);
  EXPECT_LT(difference(log.T_world_cloud[0], pose_number(1)), 1e-9);
  EXPECT_NE(notes_of(mission).find("poses matched 1 of 2 clouds by number"), std::string::npos) << notes_of(mission);
}

TEST(KittiSequence, CannotDoWithoutTheCalibration) {
  const TempFolder folder;
  write_sequence(folder, 3);
  const fs::path sequence = folder.path() / "sequences/04";
  fs::remove(sequence / "calib.txt");
  expect_source_error(open_source(sequence), ErrorCode::kNotFound, "expected calib.txt with a line `Tr:`");
  EXPECT_NE(open_source(sequence).error().hint.find("if they are the vehicle's, the same, and set T_body_sensor"),
            std::string::npos);
  folder.write("sequences/04/calib.txt", "P0: 1 2 3\n");
  expect_source_error(open_source(sequence), ErrorCode::kNotFound, "calib.txt: expected a line `Tr:`, found none");
  folder.write("sequences/04/calib.txt", "P0: 1\nTr: 1 0 0 0 0 1 0\n");
  expect_source_error(open_source(sequence), ErrorCode::kParse, "calib.txt:2: Tr: column 9: expected a number");
  folder.write("sequences/04/calib.txt", "Tr: 1 0 0 0 0 1 0 0 0 0 2 0\n");
  expect_source_error(open_source(sequence), ErrorCode::kInvalidPose, "calib.txt:1: the matrix is not a rotation");
  folder.write("sequences/04/calib.txt", "Tr: 1 0 0 0 0 1 0 0 0 0 1 inf\n");
  expect_source_error(open_source(sequence), ErrorCode::kInvalidPose, "calib.txt:1: column 13 is inf");
  folder.write("sequences/04/calib.txt", "Tr: 1 0 0 0 0 1 0 0 0 0 1 0 0\n");
  expect_source_error(open_source(sequence), ErrorCode::kParse, "found more: \"0\"");
}

TEST(KittiSequence, SaysWhichPosesItWants) {
  const TempFolder folder;
  write_sequence(folder, 3);
  const fs::path sequence = folder.path() / "sequences/04";
  folder.write("poses/04.txt", "0 0 0 0 0 0 0 1\n");
  expect_source_error(open_source(sequence), ErrorCode::kUnsupported, "found TUM (t x y z qx qy qz qw)");
  fs::remove(folder.path() / "poses/04.txt");
  expect_source_error(open_source(sequence), ErrorCode::kNotFound, "expected poses.txt, or ../../poses/04.txt");
}

}  // namespace
}  // namespace kilter
