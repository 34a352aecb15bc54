// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "kilter/base/expected.h"
#include "kilter/geometry/pose3.h"
#include "kilter/io/byte_cursor.h"

namespace kilter {

/// Whether all numbers of a line are finite. \param first_column  what the first of them is called, from 1
/// \return  kInvalidPose naming the column, without a place.
[[nodiscard]] Expected<void> check_finite_columns(std::span<const double> values, std::size_t first_column);

/// A pose from a position and a quaternion whose length is 1 up to 1 %; it is normalised.
///
/// \param position_m   all finite. [m]
/// \param quaternion   qx qy qz qw, all finite
/// \return  the pose, or kInvalidPose (too far, not of unit length), without a place.
[[nodiscard]] Expected<Pose3> pose_from_quaternion(const Eigen::Vector3d& position_m,
                                                   const Eigen::Vector4d& quaternion);

/// A pose from the rows of a 3x4 matrix, all finite. A matrix with |R^T R - I| up to 0.01 and det > 0 is moved to the
/// nearest rotation. \return  the pose, or kInvalidPose (too far, not a rotation), without a place.
[[nodiscard]] Expected<Pose3> pose_from_rows(std::span<const double, 12> rows);

/// Takes four lines of four numbers, a rigid 4x4 matrix whose last row is 0 0 0 1. Blank lines do not count.
///
/// \param name  what the matrix is called in its file, for messages
/// \return  the pose, or kTruncated (the text ends before), kParse, kInvalidPose; all with the line.
[[nodiscard]] Expected<Pose3> take_matrix(ByteCursor& text, std::string_view name, const std::string& where);

}  // namespace kilter
