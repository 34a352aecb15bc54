// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "kilter/base/expected.h"
#include "kilter/geometry/point_cloud.h"

namespace kilter {

/// Reads a PCD file: ascii, binary or binary_compressed, any fields besides x, y and z, which may be of any type.
///
/// \param bytes  the whole file
/// \param where  the file's name, for messages
/// \return  the points [m] in the file's own frame; NaN, Inf and far ones are dropped and counted; none if the header
///          says zero. Or kTruncated, kParse, kCountMismatch, kUnsupported, kOutOfMemory.
/// Memory is bounded by the bytes given, whatever the header claims: 12 B per stored point, and at most 88 times
/// the compressed size, which is all that LZF can hold. Bytes behind compressed data are ignored; behind plain data, a
/// whole record too many is kCountMismatch, unless it is all zeros: some writers pad.
[[nodiscard]] Expected<PointCloud> read_pcd(std::string_view bytes, const std::string& where);

/// The same from a file. A binary one is not held whole: 128 kB of it at a time.
/// \return  or besides what opening and reading it fails with.
[[nodiscard]] Expected<PointCloud> read_pcd_file(const std::filesystem::path& path);

}  // namespace kilter
