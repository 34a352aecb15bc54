// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>

#include "kilter/geometry/point_cloud.h"

namespace kilter {

/// The numbers that point cloud files are made of.
enum class ScalarType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kInt64, kUint64, kFloat32, kFloat64 };

/// Bytes of one scalar: 1, 2, 4 or 8.
[[nodiscard]] std::size_t size_of(ScalarType type);

/// The T stored at `bytes` (any alignment) in the given byte order. \pre sizeof(T) bytes are there.
template <typename T>
[[nodiscard]] inline T load(const char* bytes, std::endian order) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  if (order == std::endian::native) return value;
  auto raw = std::bit_cast<std::array<unsigned char, sizeof(T)>>(value);
  std::reverse(raw.begin(), raw.end());
  return std::bit_cast<T>(raw);
}

/// The scalar at `bytes` as a double; integers beyond 2^53 are rounded. \pre size_of(type) bytes are there.
[[nodiscard]] double load_scalar(const char* bytes, ScalarType type, std::endian order);

/// Where one coordinate of every point lies: the first one, and the way to the next. [m]
struct CoordinateColumn {
  const char* first = nullptr;
  std::size_t stride = 0;
  ScalarType type = ScalarType::kFloat32;
};

/// The columns of x, y and z: records side by side, or one block per field.
using PointColumns = std::array<CoordinateColumn, 3>;

/// Adds one point given as doubles; what no float can hold is counted as far.
void add_point(PointCloud& cloud, const std::array<double, 3>& point_m);

/// Makes room for `count` points in all. \pre so many are justified by bytes that are there.
void reserve_points(PointCloud& cloud, std::size_t count);

/// Adds `count` points. \pre all bytes that the columns span have been checked to be there, so that room for `count`
/// points is justified by the data. O(count).
void add_points(PointCloud& cloud, std::size_t count, const PointColumns& columns, std::endian order);

}  // namespace kilter
