// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "kilter/base/expected.h"
#include "kilter/geometry/point_cloud.h"

namespace kilter {

/// Reads the vertices of a PLY file: ascii or binary of either byte order; x, y and z of any type.
///
/// Other properties and other elements, before or behind, are skipped, lists too. Ascii files hold one row a line.
/// \param bytes  the whole file
/// \param where  the file's name, for messages
/// \return  the points [m] in the file's own frame; NaN, Inf and far ones are dropped and counted; none if the header
///          says zero. Or kTruncated, kParse, kUnsupported, kCountMismatch (vertices come last, and a whole row or
///          more is left over, not all zeros).
/// Memory is bounded by the bytes given, whatever the header claims.
[[nodiscard]] Expected<PointCloud> read_ply(std::string_view bytes, const std::string& where);

}  // namespace kilter
