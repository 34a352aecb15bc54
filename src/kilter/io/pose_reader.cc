// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/pose_reader.h"

#include <fmt/format.h>

#include <array>
#include <optional>
#include <span>

#include "kilter/io/byte_cursor.h"
#include "kilter/io/number_text.h"
#include "kilter/io/pose_numbers.h"

namespace kilter {
namespace {

constexpr std::size_t kTumColumns = 8;
constexpr std::size_t kKittiColumns = 12;
constexpr std::string_view kLayouts =
    "a pose is 8 numbers, `t x y z qx qy qz qw`, or 12, the rows of a 3x4 matrix (KITTI); begin a heading with #";

/// The numbers of one line. More than 12 are counted, not kept.
struct Row {
  std::array<double, kKittiColumns> values{};
  std::size_t columns = 0;
};

Expected<Row> parse_row(std::string_view line) {
  Row row;
  const auto next = [&] { return take_word<Separators::kBlanksAndCommas>(line); };
  for (std::string_view word = next(); !word.empty(); word = next(), ++row.columns) {
    const std::optional<double> value = parse_real(word);
    if (!value) {
      return fail(ErrorCode::kParse,
                  fmt::format("column {}: expected a number, found \"{}\"", row.columns + 1, printable(word, 40)), {},
                  std::string(kLayouts));
    }
    if (row.columns < kKittiColumns) row.values[row.columns] = *value;
  }
  return row;
}

// `expected` is the first line's number of columns, 0 for the first line itself.
Expected<void> check_columns(std::size_t found, std::size_t expected) {
  if (expected != 0 && found != expected) {
    return fail(ErrorCode::kParse,
                fmt::format("expected {} columns as in the lines before, found {}", expected, found));
  }
  if (found != kTumColumns && found != kKittiColumns) {
    return fail(ErrorCode::kParse, fmt::format("expected 8 or 12 columns, found {}", found), {}, std::string(kLayouts));
  }
  return {};
}

Expected<Pose3> pose_from_tum(const std::array<double, kKittiColumns>& v) {
  if (auto ok = check_finite_columns(std::span(v).first(kTumColumns), 1); !ok) return pass_up(ok.error());
  Expected<Pose3> pose = pose_from_quaternion({v[1], v[2], v[3]}, {v[4], v[5], v[6], v[7]});
  if (!pose) pose.error().hint = "columns are t x y z qx qy qz qw, the quaternion's real part last";
  return pose;
}

Expected<Pose3> pose_from_kitti(const std::array<double, kKittiColumns>& v) {
  if (auto ok = check_finite_columns(v, 1); !ok) return pass_up(ok.error());
  return pose_from_rows(v);
}

Expected<Pose3> parse_pose(std::string_view line, std::size_t& columns) {
  const Expected<Row> row = parse_row(line);
  if (!row) return pass_up(row.error());
  if (auto ok = check_columns(row->columns, columns); !ok) return pass_up(ok.error());
  columns = row->columns;
  return columns == kTumColumns ? pose_from_tum(row->values) : pose_from_kitti(row->values);
}

}  // namespace

Expected<std::vector<Pose3>> read_poses(std::string_view bytes, const std::string& where) {
  ByteCursor cursor(without_byte_order_mark(bytes));
  std::vector<Pose3> poses;
  std::size_t columns = 0;
  while (const std::optional<std::string_view> line = cursor.take_line()) {
    const std::string_view content = line->substr(0, line->find('#'));
    std::string_view rest = content;
    if (take_word<Separators::kBlanksAndCommas>(rest).empty()) continue;
    Expected<Pose3> pose = parse_pose(content, columns);
    if (!pose) {
      pose.error().where = fmt::format("{}:{}", where, cursor.line());
      return pass_up(std::move(pose.error()));
    }
    poses.push_back(*pose);
  }
  if (poses.empty()) return fail(ErrorCode::kEmptyInput, "the file holds no pose", where);
  return poses;
}

}  // namespace kilter
