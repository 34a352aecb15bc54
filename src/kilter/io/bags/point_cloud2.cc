// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/point_cloud2.h"

#include <fmt/format.h>

#include <array>
#include <optional>

#include "kilter/io/bags/message_cursor.h"
#include "kilter/io/bags/ros_messages.h"
#include "kilter/io/scalar.h"

namespace kilter {
namespace {

struct Field {
  std::uint32_t offset = 0;
  ScalarType type = ScalarType::kFloat32;
};

// Everything in front of the data, and where they are.
struct Layout {
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::array<std::optional<Field>, 3> xyz;
  std::optional<std::uint8_t> unknown_type;  // of x, y or z
  std::endian order = std::endian::little;
  std::uint32_t point_step = 0;
  std::uint32_t row_step = 0;
  std::string_view data;
};

// The numbers that sensor_msgs/PointField gives its types.
std::optional<ScalarType> scalar_type(std::uint8_t datatype) {
  constexpr std::array kTypes = {ScalarType::kInt8,  ScalarType::kUint8,  ScalarType::kInt16,   ScalarType::kUint16,
                                 ScalarType::kInt32, ScalarType::kUint32, ScalarType::kFloat32, ScalarType::kFloat64};
  if (datatype < 1 || datatype > kTypes.size()) return std::nullopt;
  return kTypes[datatype - 1U];
}

void take_field(MessageCursor& cursor, Layout& layout) {
  const std::string_view name = cursor.take_text();
  const auto offset = cursor.take<std::uint32_t>();
  const auto datatype = cursor.take<std::uint8_t>();
  static_cast<void>(cursor.take<std::uint32_t>());  // how many; of a coordinate there is one
  if (name != "x" && name != "y" && name != "z") return;
  std::optional<Field>& field = layout.xyz[static_cast<std::size_t>(name.front() - 'x')];
  const auto type = scalar_type(datatype);
  if (!type) layout.unknown_type = datatype;
  if (type && !field) field = Field{offset, *type};
}

Layout take_layout(MessageCursor& cursor) {
  constexpr std::size_t kMinFieldBytes = 13;
  Layout layout;
  static_cast<void>(take_header(cursor));
  layout.height = cursor.take<std::uint32_t>();
  layout.width = cursor.take<std::uint32_t>();
  const std::uint32_t fields = cursor.take_count(kMinFieldBytes);
  for (std::uint32_t i = 0; i < fields && cursor.ok(); ++i) take_field(cursor, layout);
  layout.order = cursor.take<std::uint8_t>() == 0 ? std::endian::little : std::endian::big;
  layout.point_step = cursor.take<std::uint32_t>();
  layout.row_step = cursor.take<std::uint32_t>();
  const auto length = cursor.take<std::uint32_t>();
  layout.data = cursor.take_bytes(length);
  return layout;
}

bool overlap(const Field& a, const Field& b) {
  return a.offset < std::uint64_t{b.offset} + size_of(b.type) && b.offset < std::uint64_t{a.offset} + size_of(a.type);
}

Expected<void> check_fields(const Layout& layout, const std::string& where) {
  constexpr std::string_view kNames = "xyz";
  if (layout.unknown_type) {
    return fail(ErrorCode::kParse,
                fmt::format("expected a number of type 1 to 8 for x, y and z, found type {}", *layout.unknown_type),
                where);
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::optional<Field>& field = layout.xyz[axis];
    if (!field) {
      return fail(ErrorCode::kParse, fmt::format("the cloud has no field {}", kNames.substr(axis, 1)), where);
    }
    if (std::uint64_t{field->offset} + size_of(field->type) > layout.point_step) {
      return fail(ErrorCode::kParse,
                  fmt::format("the field {} at byte {} lies outside the {} bytes of a point", kNames.substr(axis, 1),
                              field->offset, layout.point_step),
                  where);
    }
    // Else a point of one byte could stand for three numbers, and a small message for very many.
    for (std::size_t other = 0; other < axis; ++other) {
      if (!overlap(*field, *layout.xyz[other])) continue;
      return fail(
          ErrorCode::kParse,
          fmt::format("the fields {} and {} share bytes of a point", kNames.substr(other, 1), kNames.substr(axis, 1)),
          where, "look at the program that wrote it");
    }
  }
  return {};
}

// Bytes from one row to the next; a cloud of one row may say anything.
Expected<std::uint64_t> row_bytes(const Layout& layout, const std::string& where) {
  const std::uint64_t used = std::uint64_t{layout.width} * layout.point_step;
  const std::uint64_t step = layout.height > 1 ? layout.row_step : used;
  // Neither product wraps: the factors have 32 bits; the sum ends with the last row's points.
  const bool fits = used <= step && (layout.height == 0 || used <= layout.data.size()) &&
                    (layout.height <= 1 || step <= (layout.data.size() - used) / (layout.height - 1));
  if (fits) return step;
  return fail(ErrorCode::kCountMismatch,
              fmt::format("{} x {} points of {} bytes in rows of {} do not fit the {} bytes of data", layout.width,
                          layout.height, layout.point_step, layout.row_step, layout.data.size()),
              where);
}

}  // namespace

Expected<PointCloud> read_point_cloud2(std::string_view bytes, MessageEncoding encoding, const std::string& where) {
  Expected<MessageCursor> cursor = MessageCursor::open(bytes, encoding, where);
  if (!cursor) return pass_up(cursor.error());
  const Layout layout = take_layout(*cursor);
  if (!cursor->ok()) {
    return fail(ErrorCode::kTruncated, "the sensor_msgs/PointCloud2 message ends before its fields do", where);
  }
  PointCloud cloud;
  if (layout.width == 0 || layout.height == 0) return cloud;
  if (auto ok = check_fields(layout, where); !ok) return pass_up(ok.error());
  const auto step = row_bytes(layout, where);
  if (!step) return pass_up(step.error());
  const std::uint64_t points = std::uint64_t{layout.width} * layout.height;
  cloud.points_m.reserve(static_cast<std::size_t>(points));
  // Rows without gaps are one row: some clouds have as many rows as points.
  const bool has_gaps = *step != std::uint64_t{layout.width} * layout.point_step;
  const std::uint64_t rows = has_gaps ? layout.height : 1;
  for (std::uint64_t row = 0; row < rows; ++row) {
    PointColumns columns;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Field& field = *layout.xyz[axis];
      columns[axis] = {layout.data.data() + row * *step + field.offset, layout.point_step, field.type};
    }
    add_points(cloud, static_cast<std::size_t>(points / rows), columns, layout.order);
  }
  return cloud;
}

}  // namespace kilter
