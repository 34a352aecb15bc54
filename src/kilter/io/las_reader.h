// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "kilter/base/expected.h"
#include "kilter/geometry/point_cloud.h"

namespace kilter {

/// Reads the points of an uncompressed LAS file, versions 1.0 to 1.4, point formats 0 to 10: x, y and z, each a whole
/// number times the file's scale plus its offset. Everything else that a point has, and variable length records, are
/// passed over.
///
/// \param bytes  the whole file
/// \param where  the file's name, for messages
/// \return  the points [m], in the file's own frame; those beyond PointCloud::kMaxCoordinate_m are dropped and counted.
///          Or kParse (no LAS header, offsets that contradict each other, scale or offset not finite), kTruncated
///          (points or records that are promised are not there), kCountMismatch (the old and the 64-bit count differ),
///          kUnsupported (LAZ, another version or point format), kInvalidPoints: there are points and all lie too far
///          away, as in a georeferenced cloud.
[[nodiscard]] Expected<PointCloud> read_las(std::string_view bytes, const std::string& where);

/// How many points a LAS file promises.
/// \param head  the file's beginning, at least its whole header
/// \return  as read_las, for what the header alone can tell
[[nodiscard]] Expected<std::uint64_t> read_las_count(std::string_view head, const std::string& where);

}  // namespace kilter
