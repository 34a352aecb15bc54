// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "kilter/base/expected.h"
#include "kilter/geometry/point_cloud.h"
#include "kilter/io/byte_cursor.h"

namespace kilter {

/// Which numbers of a line are x, y and z.
struct TextPointLayout {
  std::uint64_t columns = 3;           ///< numbers in every line
  std::array<std::uint64_t, 3> xyz{};  ///< positions, from 0, below `columns`
};

/// Reads `count` points, one a line, all words numbers; blank lines do not count.
///
/// \return  the points, or kTruncated (fewer lines), kParse (line, what was expected, what was found).
/// Memory is bounded by the bytes left, whatever `count` says.
[[nodiscard]] Expected<PointCloud> read_text_points(ByteCursor& bytes, std::uint64_t count,
                                                    const TextPointLayout& layout, const std::string& where);

/// Takes blank lines. \return whether that was all: nothing but blanks was left.
[[nodiscard]] bool skip_blank_lines(ByteCursor& bytes);

}  // namespace kilter
