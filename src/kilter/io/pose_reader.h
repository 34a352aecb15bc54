// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/geometry/pose3.h"

namespace kilter {

/// Positions farther from the origin are refused: the Earth's centre (ECEF) and UTM northings lie within. [m]
inline constexpr double kMaxPosition_m = 1e8;

/// Reads a list of poses T_world_sensor (or T_world_submap), one a line.
///
/// The number of columns decides: 8 are `t x y z qx qy qz qw`, 12 a row-major 3x4 matrix (KITTI); every line has as
/// many as the first. Blanks or commas separate; '#' begins a comment, blank lines are skipped. Quaternions up to 1 %
/// off unit length are normalised; matrices with |R^T R - I| up to 0.01 and det > 0 are moved to the nearest rotation.
/// \param bytes  the whole file
/// \param where  the file's name, for messages
/// \return  the poses, at least one; or kParse (not a number, other number of columns), kInvalidPose (not finite, too
///          far, not a rotation), both with the line, or kEmptyInput.
[[nodiscard]] Expected<std::vector<Pose3>> read_poses(std::string_view bytes, const std::string& where);

}  // namespace kilter
