// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "kilter/base/expected.h"
#include "kilter/geometry/point_cloud.h"

namespace kilter {

/// Reads a scan as KITTI has them: float32 x y z intensity per point, little endian, no header.
///
/// \param bytes  the whole file
/// \param where  the file's name, for messages
/// \return  the points [m], sensor frame; NaN, Inf and far ones are dropped and counted. Or kTruncated: not a
///          multiple of 16 bytes, or none at all (with no header, an empty file cannot say that it means it). Or
///          kUnsupported: one intensity in twenty, and at least 20, are below -1, so these are records of another size.
[[nodiscard]] Expected<PointCloud> read_bin(std::string_view bytes, const std::string& where);

}  // namespace kilter
