// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "kilter/base/expected.h"
#include "kilter/geometry/point_cloud.h"
#include "kilter/submap/robot_log.h"

namespace kilter {

/// Whether a cloud has a point that can be used. \param where  its file. \return kInvalidPoints, and why none can.
[[nodiscard]] Expected<void> check_usable(const PointCloud& cloud, const std::string& where);

/// Whether any of a robot's clouds has a point that can be used; they are read until one has, which is mostly the
/// first. Octrees are not looked at. \return kInvalidPoints for the first cloud. A cloud that cannot be read is left to
/// who reads it for its points.
[[nodiscard]] Expected<void> check_usable(const RobotLog& robot);

}  // namespace kilter
