// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "kilter/base/expected.h"
#include "kilter/geometry/point_cloud.h"
#include "kilter/io/bags/ros_type.h"

namespace kilter {

/// Reads a sensor_msgs/PointCloud2: x, y and z of any type of number and any order, whatever other fields there are.
///
/// \param bytes  the whole message
/// \param where  for messages
/// \return  the points [m] in the frame that its header names; NaN, Inf and far ones are dropped and counted. Or
///          kTruncated (it ends inside a field), kParse (no x, y, z; a field outside the point, or two that share
///          bytes), kCountMismatch (width x height points do not fit the data), kUnsupported.
/// 12 B for each point that the data hold.
[[nodiscard]] Expected<PointCloud> read_point_cloud2(std::string_view bytes, MessageEncoding encoding,
                                                     const std::string& where);

}  // namespace kilter
