// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/io/byte_cursor.h"
#include "kilter/io/scalar.h"

namespace kilter {

/// How the points follow the header.
enum class PcdData {
  kAscii,             ///< a line per point
  kBinary,            ///< a record per point, little endian, packed
  kBinaryCompressed,  ///< LZF over one block per field
};

/// One field of a PCD record.
struct PcdField {
  std::string_view name;
  ScalarType type = ScalarType::kFloat32;
  std::uint64_t count = 1;         ///< values per point; 0 for a field that is named but not stored
  std::uint64_t first_column = 0;  ///< values before it in a record
  std::uint64_t offset = 0;        ///< bytes before it in a record
};

/// What a PCD file says about itself. Checked in itself, not yet against the bytes that follow.
struct PcdHeader {
  std::vector<PcdField> fields;
  std::array<std::size_t, 3> xyz{};  ///< indices into `fields`; each has count 1
  std::uint64_t columns = 0;         ///< values per point
  std::uint64_t record_bytes = 0;    ///< bytes per point, >= 3
  std::uint64_t points = 0;
  PcdData data = PcdData::kAscii;
};

/// Reads the lines up to and including DATA. Names in the result point into the cursor's bytes.
///
/// VERSION 0.5 to 0.7 (".7" too); COUNT may be missing; VIEWPOINT is ignored: kilter takes poses from `poses.*`.
/// \return  the header, or kTruncated (no DATA line), kParse (line and what was expected), kCountMismatch
///          (WIDTH x HEIGHT is not POINTS), kUnsupported (another version).
[[nodiscard]] Expected<PcdHeader> read_pcd_header(ByteCursor& bytes, const std::string& where);

}  // namespace kilter
