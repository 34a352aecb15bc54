// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/pose_reader.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "kilter/io/byte_cursor.h"
#include "kilter/io/number_text.h"

namespace kilter {
namespace {

constexpr std::size_t kTumColumns = 8;
constexpr std::size_t kKittiColumns = 12;
constexpr double kMaxRotationError = 0.01;
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

Expected<void> check_finite(std::span<const double> values, const Eigen::Vector3d& position_m) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) {
      return fail(ErrorCode::kInvalidPose, fmt::format("column {} is {}, not a finite number", i + 1, values[i]));
    }
  }
  if (position_m.cwiseAbs().maxCoeff() > kMaxPosition_m) {
    return fail(ErrorCode::kInvalidPose, fmt::format("position ({}, {}, {}) m is farther than {} m from the origin",
                                                     position_m.x(), position_m.y(), position_m.z(), kMaxPosition_m));
  }
  return {};
}

Expected<Pose3> pose_from_tum(const std::array<double, kKittiColumns>& v) {
  const Eigen::Vector3d position_m(v[1], v[2], v[3]);
  if (auto ok = check_finite(std::span(v).first(kTumColumns), position_m); !ok) return pass_up(ok.error());
  // Not norm(): squares of huge components must not overflow into a harmless-looking error.
  const double norm = Eigen::Vector4d(v[4], v[5], v[6], v[7]).stableNorm();
  if (!(std::abs(norm - 1.0) <= kMaxRotationError)) {
    return fail(ErrorCode::kInvalidPose,
                fmt::format("quaternion ({}, {}, {}, {}) has length {:.6g}, more than 1 % away from 1", v[4], v[5],
                            v[6], v[7], norm),
                {}, "columns are t x y z qx qy qz qw, the quaternion's real part last");
  }
  return Pose3(Eigen::Quaterniond(v[7], v[4], v[5], v[6]), position_m);
}

Expected<Pose3> pose_from_kitti(const std::array<double, kKittiColumns>& v) {
  const Eigen::Vector3d position_m(v[3], v[7], v[11]);
  if (auto ok = check_finite(v, position_m); !ok) return pass_up(ok.error());
  Eigen::Matrix3d R;
  R << v[0], v[1], v[2], v[4], v[5], v[6], v[8], v[9], v[10];
  const double error = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(error <= kMaxRotationError)) {
    return fail(ErrorCode::kInvalidPose,
                fmt::format("the matrix is not a rotation: R^T R differs from I by {:.3g}, at most {} is accepted",
                            error, kMaxRotationError));
  }
  if (R.determinant() < 0.0) {
    return fail(ErrorCode::kInvalidPose, "the matrix is a reflection, not a rotation: its determinant is -1");
  }
  // The nearest rotation: polar factor U V^T.
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d nearest = svd.matrixU() * svd.matrixV().transpose();
  return Pose3(Eigen::Quaterniond(nearest), position_m);
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
