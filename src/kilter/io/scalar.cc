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

// Whether all numbers are finite and no farther than a point may be. Without a branch, so that it takes several at
// once: floats of one sign order as their bits do, and NaN and infinity lie beyond all others.
bool are_usable(const float* values, std::size_t count) {
  constexpr auto kFarthest = std::bit_cast<std::int32_t>(PointCloud::kMaxCoordinate_m);
  std::int32_t beyond = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t magnitude = std::bit_cast<std::int32_t>(values[i]) & 0x7FFFFFFF;
    beyond |= static_cast<std::int32_t>(magnitude > kFarthest);
  }
  return beyond == 0;
}

void copy_floats(float* into, std::size_t count, const PointColumns& columns) {
  const auto [x, y, z] = columns;
  const bool is_packed = x.stride == 3 * sizeof(float) && y.first == x.first + 4 && z.first == x.first + 8 &&
                         y.stride == x.stride && z.stride == x.stride && std::endian::native == std::endian::little;
  if (is_packed) {
    std::memcpy(into, x.first, count * 3 * sizeof(float));
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    into[3 * i] = load<float>(x.first + i * x.stride, std::endian::little);
    into[3 * i + 1] = load<float>(y.first + i * y.stride, std::endian::little);
    into[3 * i + 2] = load<float>(z.first + i * z.stride, std::endian::little);
  }
}

// Block by block: copied as if all were good, and only where one is not, again with care.
void add_float_points(PointCloud& cloud, std::size_t count, const PointColumns& columns) {
  constexpr std::size_t kBlock = 1024;
  PointColumns rest = columns;
  while (count > 0) {
    const std::size_t here = std::min(count, kBlock);
    const std::size_t before = cloud.points_m.size();
    cloud.points_m.resize(before + here);
    float* const block = cloud.points_m[before].data();
    copy_floats(block, here, rest);
    if (!are_usable(block, 3 * here)) {
      cloud.points_m.resize(before);
      for (std::size_t i = 0; i < here; ++i) {
        cloud.add(load<float>(rest[0].first + i * rest[0].stride, std::endian::little),
                  load<float>(rest[1].first + i * rest[1].stride, std::endian::little),
                  load<float>(rest[2].first + i * rest[2].stride, std::endian::little));
      }
    }
    for (CoordinateColumn& column : rest) column.first += here * column.stride;
    count -= here;
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

void reserve_points(PointCloud& cloud, std::size_t count) {
  if (count <= cloud.points_m.capacity()) return;
  cloud.points_m.reserve(count);
  advise_large_pages(cloud.points_m.data(), cloud.points_m.capacity() * sizeof(Eigen::Vector3f));
}

void add_points(PointCloud& cloud, std::size_t count, const PointColumns& columns, std::endian order) {
  reserve_points(cloud, cloud.points_m.size() + count);
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
