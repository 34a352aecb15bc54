// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/ply_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "kilter/io/byte_cursor.h"
#include "kilter/io/number_text.h"
#include "kilter/io/ply_header.h"
#include "kilter/io/text_points.h"

namespace kilter {
namespace {

// Where x, y and z were found in a row of variable length.
using Point = std::array<double, 3>;

tl::unexpected<Error> rows_missing(const PlyElement& element, std::uint64_t done, const std::string& where) {
  return fail(ErrorCode::kTruncated,
              fmt::format("the header promises {} rows of element \"{}\", but only {} follow", element.rows,
                          printable(element.name, 40), done),
              where);
}

// Which axis property `index` of the vertices is; 3 for none.
std::size_t axis_of(const std::array<std::size_t, 3>& xyz, std::size_t index) {
  return static_cast<std::size_t>(std::find(xyz.begin(), xyz.end(), index) - xyz.begin());
}

// One binary row. \return false if the bytes end within it, or a list's length is negative.
bool take_binary_row(ByteCursor& bytes, const PlyElement& element, const PlyHeader& header, Point& point) {
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    const PlyProperty& property = element.properties[i];
    std::uint64_t values = 1;
    if (property.length_type) {
      const auto length = bytes.take(size_of(*property.length_type));
      const double claimed = length ? load_scalar(length->data(), *property.length_type, header.order) : -1.0;
      // More values than bytes cannot be there; the bound also makes the cast safe.
      if (claimed < 0.0 || claimed > static_cast<double>(bytes.remaining())) return false;
      values = static_cast<std::uint64_t>(claimed);
    }
    const auto taken = bytes.take(values * size_of(property.type));
    if (!taken) return false;
    const std::size_t axis = axis_of(header.xyz, i);
    if (axis < 3 && !property.length_type) point[axis] = load_scalar(taken->data(), property.type, header.order);
  }
  return true;
}

// Takes all rows of an element; of the vertices, the points.
Expected<void> take_binary_rows(ByteCursor& bytes, const PlyElement& element, const PlyHeader& header,
                                const std::string& where, PointCloud* cloud) {
  if (element.properties.empty()) return {};  // rows of no bytes, however many
  for (std::uint64_t row = 0; row < element.rows; ++row) {
    Point point_m{};
    const std::size_t start = bytes.position();
    if (!take_binary_row(bytes, element, header, point_m)) {
      return fail(ErrorCode::kTruncated,
                  fmt::format("row {} of {} of element \"{}\", at byte {}, is longer than what is left of the file",
                              row, element.rows, printable(element.name, 40), start),
                  where);
    }
    if (cloud != nullptr) add_point(*cloud, point_m);
  }
  return {};
}

// Takes a table without lists in one step.
Expected<std::string_view> take_table(ByteCursor& bytes, const PlyElement& element, const std::string& where) {
  const std::uint64_t row_bytes = element.row_bytes();
  const auto total = checked_product(element.rows, row_bytes);
  const std::size_t left = bytes.remaining();
  if (const auto table = total ? bytes.take(*total) : std::nullopt) return *table;
  return fail(
      ErrorCode::kTruncated,
      fmt::format("the header promises {} rows of {} bytes of element \"{}\", but only {} bytes follow ({} rows)",
                  element.rows, row_bytes, printable(element.name, 40), left, left / row_bytes),
      where);
}

Expected<PointCloud> take_binary_vertices(ByteCursor& bytes, const PlyHeader& header, const std::string& where) {
  const PlyElement& vertex = header.elements[header.vertex];
  PointCloud cloud;
  if (vertex.has_lists()) {
    if (auto taken = take_binary_rows(bytes, vertex, header, where, &cloud); !taken) return pass_up(taken.error());
    return cloud;
  }
  const Expected<std::string_view> table = take_table(bytes, vertex, where);
  if (!table) return pass_up(table.error());
  PointColumns columns;
  std::size_t offset = 0;
  for (std::size_t i = 0; i < vertex.properties.size(); ++i) {
    const ScalarType type = vertex.properties[i].type;
    if (const std::size_t axis = axis_of(header.xyz, i); axis < 3) {
      columns[axis] = {table->data() + offset, vertex.row_bytes(), type};
    }
    offset += size_of(type);
  }
  add_points(cloud, vertex.rows, columns, header.order);
  if (header.vertex + 1 == header.elements.size() && bytes.remaining() >= vertex.row_bytes() &&
      !is_padding(bytes.rest())) {
    return fail(ErrorCode::kCountMismatch,
                fmt::format("{} vertices of {} bytes are promised, and {} bytes more follow", vertex.rows,
                            vertex.row_bytes(), bytes.remaining()),
                where);
  }
  return cloud;
}

Expected<PointCloud> read_binary(ByteCursor& bytes, const PlyHeader& header, const std::string& where) {
  for (std::size_t i = 0; i < header.vertex; ++i) {
    const PlyElement& element = header.elements[i];
    if (element.has_lists()) {
      if (auto taken = take_binary_rows(bytes, element, header, where, nullptr); !taken) return pass_up(taken.error());
    } else if (!element.properties.empty()) {
      if (auto table = take_table(bytes, element, where); !table) return pass_up(table.error());
    }
  }
  return take_binary_vertices(bytes, header, where);
}

// The next line that is not blank.
std::optional<std::string_view> take_row(ByteCursor& bytes) {
  return skip_blank_lines(bytes) ? std::nullopt : bytes.take_line();
}

// One ascii row whose lists make its length vary.
Expected<Point> parse_row(std::string_view line, const PlyElement& element, const PlyHeader& header) {
  Point point{};
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    const PlyProperty& property = element.properties[i];
    std::uint64_t values = 1;
    if (property.length_type) {
      const std::string_view word = take_word(line);
      const auto length = parse_count(word);
      if (!length) {
        return fail(ErrorCode::kParse, fmt::format("expected the length of list \"{}\", found \"{}\"",
                                                   printable(property.name, 40), printable(word, 40)));
      }
      values = *length;
    }
    for (std::uint64_t k = 0; k < values; ++k) {
      const std::string_view word = take_word(line);
      const auto value = parse_real(word);
      if (!value) {  // at the latest where the line ends, however long the list claims to be
        return fail(ErrorCode::kParse, fmt::format("expected a number for \"{}\", found \"{}\"",
                                                   printable(property.name, 40), printable(word, 40)));
      }
      const std::size_t axis = axis_of(header.xyz, i);
      if (axis < 3 && !property.length_type) point[axis] = *value;
    }
  }
  if (!take_word(line).empty()) return fail(ErrorCode::kParse, "the line has more numbers than its element's row");
  return point;
}

Expected<PointCloud> take_text_vertices_with_lists(ByteCursor& bytes, const PlyHeader& header,
                                                   const std::string& where) {
  const PlyElement& vertex = header.elements[header.vertex];
  PointCloud cloud;
  for (std::uint64_t row = 0; row < vertex.rows; ++row) {
    const auto line = take_row(bytes);
    if (!line) return rows_missing(vertex, row, where);
    Expected<Point> point = parse_row(*line, vertex, header);
    if (!point) {
      point.error().where = fmt::format("{}:{}", where, bytes.line());
      return pass_up(std::move(point.error()));
    }
    add_point(cloud, *point);
  }
  return cloud;
}

Expected<PointCloud> read_ascii(ByteCursor& bytes, const PlyHeader& header, const std::string& where) {
  for (std::size_t i = 0; i < header.vertex; ++i) {
    const PlyElement& element = header.elements[i];
    if (element.properties.empty()) continue;
    for (std::uint64_t row = 0; row < element.rows; ++row) {
      if (!take_row(bytes)) return rows_missing(element, row, where);
    }
  }
  const PlyElement& vertex = header.elements[header.vertex];
  const TextPointLayout layout = {.columns = vertex.properties.size(),
                                  .xyz = {header.xyz[0], header.xyz[1], header.xyz[2]}};
  Expected<PointCloud> cloud = vertex.has_lists() ? take_text_vertices_with_lists(bytes, header, where)
                                                  : read_text_points(bytes, vertex.rows, layout, where);
  if (cloud && header.vertex + 1 == header.elements.size() && !skip_blank_lines(bytes)) {
    return fail(ErrorCode::kCountMismatch,
                fmt::format("the header promises {} vertices, but more lines follow", vertex.rows),
                fmt::format("{}:{}", where, bytes.line() + 1));
  }
  return cloud;
}

}  // namespace

Expected<PointCloud> read_ply(std::string_view bytes, const std::string& where) {
  ByteCursor cursor(without_byte_order_mark(bytes));
  const Expected<PlyHeader> header = read_ply_header(cursor, where);
  if (!header) return pass_up(header.error());
  return header->is_ascii ? read_ascii(cursor, *header, where) : read_binary(cursor, *header, where);
}

}  // namespace kilter
