// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/io/byte_cursor.h"
#include "kilter/io/scalar.h"

namespace kilter {

/// A named value, or a list of values behind its own length, in each row of an element.
struct PlyProperty {
  std::string_view name;
  ScalarType type = ScalarType::kFloat32;
  std::optional<ScalarType> length_type;  ///< given for lists; an integer type
};

/// One table of a PLY file, e.g. "vertex".
struct PlyElement {
  std::string_view name;
  std::uint64_t rows = 0;
  std::vector<PlyProperty> properties;

  [[nodiscard]] bool has_lists() const;
  /// Bytes of a binary row. \pre no lists
  [[nodiscard]] std::uint64_t row_bytes() const;
};

/// What a PLY file says about itself. Checked in itself, not yet against the bytes that follow.
struct PlyHeader {
  bool is_ascii = false;
  std::endian order = std::endian::little;  ///< of binary data
  std::vector<PlyElement> elements;         ///< in the order of the file
  std::size_t vertex = 0;                   ///< index of the element "vertex"
  std::array<std::size_t, 3> xyz{};         ///< indices into its properties; none is a list
};

/// Reads the lines up to and including end_header. Names in the result point into the cursor's bytes.
///
/// Old and new type names ("float", "float32"); comment and obj_info lines are ignored.
/// \return  the header, or kTruncated (no end_header), kParse (line and what was expected; no vertex, x, y or z),
///          kUnsupported (another format version).
[[nodiscard]] Expected<PlyHeader> read_ply_header(ByteCursor& bytes, const std::string& where);

}  // namespace kilter
