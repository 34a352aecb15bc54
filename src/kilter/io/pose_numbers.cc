// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/pose_numbers.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>

#include "kilter/io/number_text.h"
#include "kilter/io/pose_reader.h"

namespace kilter {
namespace {

constexpr double kMaxRotationError = 0.01;

Expected<void> check_position(const Eigen::Vector3d& position_m) {
  if (position_m.cwiseAbs().maxCoeff() <= kMaxPosition_m) return {};
  return fail(ErrorCode::kInvalidPose, fmt::format("position ({}, {}, {}) m is farther than {} m from the origin",
                                                   position_m.x(), position_m.y(), position_m.z(), kMaxPosition_m));
}

// The next line that holds anything; an empty text at the end.
std::string_view take_filled_line(ByteCursor& text) {
  while (const std::optional<std::string_view> line = text.take_line()) {
    std::string_view rest = *line;
    if (!take_word(rest).empty()) return *line;
  }
  return {};
}

Expected<void> parse_matrix_row(std::string_view line, std::span<double> row) {
  for (std::size_t i = 0; i < row.size(); ++i) {
    const std::string_view word = take_word(line);
    const std::optional<double> value = parse_real(word);
    if (!value) {
      return fail(ErrorCode::kParse,
                  fmt::format("column {}: expected a number, found \"{}\"", i + 1, printable(word, 40)));
    }
    row[i] = *value;
  }
  if (const std::string_view more = take_word(line); !more.empty()) {
    return fail(ErrorCode::kParse, fmt::format("expected 4 columns, found more: \"{}\"", printable(more, 40)));
  }
  return check_finite_columns(row, 1);
}

Expected<void> check_last_row(std::span<const double, 4> row) {
  constexpr std::array kLast = {0.0, 0.0, 0.0, 1.0};
  constexpr double kTolerance = 1e-6;
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (std::abs(row[i] - kLast[i]) <= kTolerance) continue;
    return fail(ErrorCode::kInvalidPose, fmt::format("expected 0 0 0 1 as the last row of a rigid matrix, found "
                                                     "{} {} {} {}",
                                                     row[0], row[1], row[2], row[3]));
  }
  return {};
}

}  // namespace

Expected<void> check_finite_columns(std::span<const double> values, std::size_t first_column) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i])) continue;
    return fail(ErrorCode::kInvalidPose,
                fmt::format("column {} is {}, not a finite number", first_column + i, values[i]));
  }
  return {};
}

Expected<Pose3> pose_from_quaternion(const Eigen::Vector3d& position_m, const Eigen::Vector4d& quaternion) {
  if (auto ok = check_position(position_m); !ok) return pass_up(ok.error());
  // Not norm(): squares of huge components must not overflow into a harmless-looking error.
  const double norm = quaternion.stableNorm();
  if (!(std::abs(norm - 1.0) <= kMaxRotationError)) {
    return fail(ErrorCode::kInvalidPose,
                fmt::format("quaternion ({}, {}, {}, {}) has length {:.6g}, more than 1 % away from 1", quaternion[0],
                            quaternion[1], quaternion[2], quaternion[3], norm));
  }
  return Pose3(Eigen::Quaterniond(quaternion[3], quaternion[0], quaternion[1], quaternion[2]), position_m);
}

Expected<Pose3> pose_from_rows(std::span<const double, 12> rows) {
  const Eigen::Vector3d position_m(rows[3], rows[7], rows[11]);
  if (auto ok = check_position(position_m); !ok) return pass_up(ok.error());
  Eigen::Matrix3d R;
  R << rows[0], rows[1], rows[2], rows[4], rows[5], rows[6], rows[8], rows[9], rows[10];
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

Expected<Pose3> take_matrix(ByteCursor& text, std::string_view name, const std::string& where) {
  std::array<double, 16> values{};
  const auto here = [&] { return fmt::format("{}:{}", where, text.line()); };
  const auto placed = [&](Error error) {
    error.where = here();
    error.message = fmt::format("{}: {}", name, error.message);
    return pass_up(std::move(error));
  };
  for (std::size_t row = 0; row < 4; ++row) {
    const std::string_view line = take_filled_line(text);
    if (line.empty()) {
      return fail(ErrorCode::kTruncated,
                  fmt::format("{}: expected 4 rows of 4 numbers, the file ends after {}", name, row), here());
    }
    auto ok = parse_matrix_row(line, std::span(values).subspan(4 * row, 4));
    if (ok && row == 3) ok = check_last_row(std::span(values).last<4>());
    if (!ok) return placed(std::move(ok.error()));
  }
  Expected<Pose3> pose = pose_from_rows(std::span(values).first<12>());
  if (!pose) return placed(std::move(pose.error()));
  return pose;
}

}  // namespace kilter
