// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/scalar.h"

#include <cmath>
#include <limits>

#include "kilter/io/large_pages.h"

namespace kilter {
namespace {

// Casting a double beyond the floats is undefined; the largest float is as far as any.
float to_float(double value) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  if (std::isfinite(value)) value = std::clamp(value, -kLargest, kLargest);
  return static_cast<float>(value);
}

void add_float_points(PointCloud& cloud, std::size_t count, const PointColumns& columns) {
  const auto [x, y, z] = columns;
  for (std::size_t i = 0; i < count; ++i) {
    cloud.add(load<float>(x.first + i * x.stride, std::endian::little),
              load<float>(y.first + i * y.stride, std::endian::little),
              load<float>(z.first + i * z.stride, std::endian::little));
  }
}

}  // namespace

std::size_t size_of(ScalarType type) {
  switch (type) {
    case ScalarType::kInt8:
    case ScalarType::kUint8:
      return 1;
    case ScalarType::kInt16:
    case ScalarType::kUint16:
      return 2;
    case ScalarType::kInt32:
    case ScalarType::kUint32:
    case ScalarType::kFloat32:
      return 4;
    case ScalarType::kInt64:
    case ScalarType::kUint64:
    case ScalarType::kFloat64:
      return 8;
  }
  return 8;
}

double load_scalar(const char* bytes, ScalarType type, std::endian order) {
  switch (type) {
    case ScalarType::kInt8:
      return load<std::int8_t>(bytes, order);
    case ScalarType::kUint8:
      return load<std::uint8_t>(bytes, order);
    case ScalarType::kInt16:
      return load<std::int16_t>(bytes, order);
    case ScalarType::kUint16:
      return load<std::uint16_t>(bytes, order);
    case ScalarType::kInt32:
      return load<std::int32_t>(bytes, order);
    case ScalarType::kUint32:
      return load<std::uint32_t>(bytes, order);
    case ScalarType::kInt64:
      return static_cast<double>(load<std::int64_t>(bytes, order));
    case ScalarType::kUint64:
      return static_cast<double>(load<std::uint64_t>(bytes, order));
    case ScalarType::kFloat32:
      return load<float>(bytes, order);
    case ScalarType::kFloat64:
      return load<double>(bytes, order);
  }
  return 0.0;
}

void add_point(PointCloud& cloud, const std::array<double, 3>& point_m) {
  cloud.add(to_float(point_m[0]), to_float(point_m[1]), to_float(point_m[2]));
}

void add_points(PointCloud& cloud, std::size_t count, const PointColumns& columns, std::endian order) {
  cloud.points_m.reserve(cloud.points_m.size() + count);
  advise_large_pages(cloud.points_m.data(), cloud.points_m.capacity() * sizeof(Eigen::Vector3f));
  const bool floats = std::all_of(columns.begin(), columns.end(),
                                  [](const CoordinateColumn& c) { return c.type == ScalarType::kFloat32; });
  // The common case by far, kept free of the switch over types.
  if (floats && order == std::endian::little) return add_float_points(cloud, count, columns);
  for (std::size_t i = 0; i < count; ++i) {
    std::array<double, 3> point_m{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const CoordinateColumn& column = columns[axis];
      point_m[axis] = load_scalar(column.first + i * column.stride, column.type, order);
    }
    add_point(cloud, point_m);
  }
}

}  // namespace kilter
