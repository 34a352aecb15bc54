// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>

namespace kilter {

/// Points as a binary PCD file with float x y z, in their own frame. [m]
[[nodiscard]] std::string cloud_pcd(std::span<const Eigen::Vector3f> points_m);

}  // namespace kilter
