// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <string_view>

#include "kilter/geometry/pose3.h"

namespace kilter {

/// Points moved by a pose, as a binary little-endian PLY with float x y z: the type that points have here, and the only
/// one that PCL's readers of points take. [m]
/// \param frame  what the result's frame is called, for a comment
[[nodiscard]] std::string cloud_ply(std::span<const Eigen::Vector3f> points_m, const Pose3& T_frame_points,
                                    std::string_view frame);

}  // namespace kilter
