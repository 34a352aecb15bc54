// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/sources/kitti_sequence.h"

#include <fmt/format.h>

#include <array>
#include <system_error>

#include "kilter/io/byte_cursor.h"
#include "kilter/io/file.h"
#include "kilter/io/number_text.h"
#include "kilter/io/pose_file.h"
#include "kilter/io/pose_list.h"
#include "kilter/io/pose_numbers.h"
#include "kilter/io/sources/cloud_folder.h"

namespace kilter {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxCalibrationBytes = std::uint64_t{1} << 20;

Expected<Pose3> parse_twelve(std::string_view line) {
  std::array<double, 12> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string_view word = take_word(line);
    const std::optional<double> value = parse_real(word);
    if (!value) {
      return fail(ErrorCode::kParse,
                  fmt::format("Tr: column {}: expected a number, found \"{}\"", i + 2, printable(word, 40)), {},
                  "Tr: has twelve numbers, the rows of a 3x4 matrix from the velodyne to the left camera");
    }
    values[i] = *value;
  }
  if (const std::string_view more = take_word(line); !more.empty()) {
    return fail(ErrorCode::kParse, fmt::format("Tr: expected 12 numbers, found more: \"{}\"", printable(more, 40)));
  }
  if (auto ok = check_finite_columns(values, 2); !ok) return pass_up(ok.error());
  return pose_from_rows(values);
}

Expected<Pose3> read_calibration(const fs::path& sequence) {
  const fs::path file = sequence / "calib.txt";
  if (!is_file(file)) {
    return fail(ErrorCode::kNotFound, "expected calib.txt with a line `Tr:`, found none", shown(sequence),
                "KITTI's poses are the camera's and cannot be used without it. If yours are the lidar's own, name the "
                "folder of scans `scans` instead of `velodyne`; if they are the vehicle's, the same, and set "
                "T_body_sensor");
  }
  const auto bytes = read_file(file, kMaxCalibrationBytes);
  if (!bytes) return pass_up(bytes.error());
  return parse_kitti_calibration(bytes->view(), shown(file));
}

// The sequence's name as KITTI has it, "00", also where the folder was named "." or through a link.
std::string name_of_sequence(const fs::path& sequence) {
  std::error_code error;
  const fs::path canonical = fs::canonical(sequence, error);
  return (error ? sequence : canonical).filename().string();
}

Expected<fs::path> find_poses(const fs::path& sequence) {
  const fs::path own = sequence / "poses.txt";
  if (is_file(own)) return own;
  const std::string file = name_of_sequence(sequence) + ".txt";
  fs::path shared = sequence / ".." / ".." / "poses" / file;
  if (is_file(shared)) return shared;
  return fail(ErrorCode::kNotFound,
              fmt::format("expected poses.txt, or ../../poses/{}, found neither", printable(file, 80)), shown(sequence),
              "KITTI has true poses for sequences 00 to 10; write your own estimate as poses.txt");
}

Expected<std::vector<Pose3>> read_camera_poses(const fs::path& file) {
  const auto bytes = read_file(file, kMaxPoseFileBytes);
  if (!bytes) return pass_up(bytes.error());
  auto list = read_pose_list(bytes->view(), shown(file));
  if (!list) return pass_up(list.error());
  if (list->layout == PoseLayout::kKitti) return std::move(list->T_world_cloud);
  return fail(
      ErrorCode::kUnsupported,
      fmt::format("expected twelve columns, the camera's poses as KITTI has them, found {}", name_of(list->layout)),
      shown(file),
      "if these are the lidar's own poses, name the folder of scans `scans` instead of `velodyne`; if they are "
      "the vehicle's, the same, and set T_body_sensor");
}

}  // namespace

Expected<Pose3> parse_kitti_calibration(std::string_view bytes, const std::string& where) {
  ByteCursor cursor(without_byte_order_mark(bytes));
  while (const std::optional<std::string_view> line = cursor.take_line()) {
    std::string_view rest = *line;
    if (take_word(rest) != "Tr:") continue;
    Expected<Pose3> pose = parse_twelve(rest);
    if (!pose) pose.error().where = fmt::format("{}:{}", where, cursor.line());
    return pose;
  }
  return fail(ErrorCode::kNotFound, "expected a line `Tr:`, found none", where,
              "it is the pose of the velodyne in the left camera's frame");
}

bool is_kitti_sequence(const fs::path& folder) {
  return is_folder(folder / "velodyne") &&
         (is_file(folder / "calib.txt") || is_file(folder / "poses.txt") || is_file(folder / "times.txt"));
}

Expected<RobotLog> open_kitti_sequence(const SourceRequest& request, std::vector<std::string>& notes) {
  const fs::path scans = request.path / "velodyne";
  const auto names = list_clouds_of(scans);
  if (!names) return pass_up(names.error());
  const Expected<Pose3> T_cam0_velo = read_calibration(request.path);
  if (!T_cam0_velo) return pass_up(T_cam0_velo.error());
  const Expected<fs::path> pose_file = find_poses(request.path);
  if (!pose_file) return pass_up(pose_file.error());
  auto poses = read_camera_poses(*pose_file);
  if (!poses) return pass_up(poses.error());
  for (Pose3& pose : *poses) pose = T_cam0_velo->inverse() * pose * *T_cam0_velo;
  RobotLog log;
  log.name = request.name;
  const Stamps stamps = read_stamps_if_any(request.path / "times.txt", poses->size(), log.name, notes);
  if (auto ok = pair_by_number(log, scans, *names, number_from_zero(*poses), stamps, {*pose_file, "pose"}, notes); !ok)
    return pass_up(ok.error());
  return log;
}

}  // namespace kilter
