// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/text_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "kilter/io/number_text.h"
#include "kilter/io/scalar.h"

namespace kilter {
namespace {

// Takes one point from a line that is not blank; the error's place is the caller's to add.
Expected<void> add_line(std::string_view line, const TextPointLayout& layout, PointCloud& cloud) {
  std::array<double, 3> point_m{};
  std::uint64_t column = 0;
  for (std::string_view word = take_word(line); !word.empty(); word = take_word(line), ++column) {
    const std::optional<double> value = parse_real(word);
    if (!value) return fail(ErrorCode::kParse, fmt::format("expected a number, found \"{}\"", printable(word, 40)));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (layout.xyz[axis] == column) point_m[axis] = *value;
    }
  }
  if (column != layout.columns) {
    return fail(ErrorCode::kParse, fmt::format("expected {} numbers, found {}", layout.columns, column));
  }
  add_point(cloud, point_m);
  return {};
}

bool is_blank(std::string_view line) { return take_word(line).empty(); }

}  // namespace

Expected<PointCloud> read_text_points(ByteCursor& bytes, std::uint64_t count, const TextPointLayout& layout,
                                      const std::string& where) {
  PointCloud cloud;
  // A number takes a digit and what separates it from the next.
  const std::uint64_t most_points = (bytes.remaining() + 1) / 2 / layout.columns;
  cloud.points_m.reserve(std::min(count, most_points));
  for (std::uint64_t done = 0; done < count;) {
    const std::optional<std::string_view> line = bytes.take_line();
    if (!line) {
      return fail(ErrorCode::kTruncated,
                  fmt::format("the header promises {} points, but only {} follow it", count, done), where);
    }
    if (is_blank(*line)) continue;
    if (auto added = add_line(*line, layout, cloud); !added) {
      added.error().where = fmt::format("{}:{}", where, bytes.line());
      return pass_up(std::move(added.error()));
    }
    ++done;
  }
  return cloud;
}

bool skip_blank_lines(ByteCursor& bytes) {
  while (bytes.remaining() > 0) {
    ByteCursor ahead = bytes;
    if (!is_blank(*ahead.take_line())) return false;
    bytes = ahead;
  }
  return true;
}

}  // namespace kilter
