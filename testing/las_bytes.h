// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "testing/cloud_bytes.h"

namespace kilter_testing {

/// A LAS file by its fields: version 1.2, format 1, two points unless told otherwise.
struct LasBytes {
  std::string signature = "LASF";
  std::uint8_t minor = 2;
  std::uint16_t header_bytes = 227;
  std::uint32_t points_at = 227;
  std::uint32_t records = 0;
  std::string record_bytes;  ///< between header and points; points_at is the caller's
  std::uint8_t format = 1;
  std::uint16_t point_bytes = 28;
  std::uint32_t old_count = 2;
  std::uint64_t count = 0;  ///< of version 1.4
  std::array<double, 3> scale = {0.001, 0.001, 0.01};
  std::array<double, 3> offset_m = {100.0, 0.0, -5.0};
  std::vector<std::array<std::int32_t, 3>> points = {{1000, -2500, 700}, {-100000, 1, 500}};

  [[nodiscard]] std::string str() const {
    std::string bytes = signature + std::string(20, '\0');
    put<std::uint8_t>(bytes, 1);
    put(bytes, minor);
    bytes.resize(94, '\0');
    put(bytes, header_bytes);
    put(bytes, points_at);
    put(bytes, records);
    put(bytes, format);
    put(bytes, point_bytes);
    put(bytes, old_count);
    bytes.resize(131, '\0');
    for (const double number : scale) put(bytes, number);
    for (const double number : offset_m) put(bytes, number);
    bytes.resize(227, '\0');
    if (minor >= 4) {
      bytes.resize(247, '\0');
      put(bytes, count);
    }
    bytes.resize(header_bytes, '\0');
    bytes += record_bytes;
    for (const std::array<std::int32_t, 3>& point : points) {
      const std::size_t end = bytes.size() + point_bytes;
      for (const std::int32_t number : point) put(bytes, number);
      bytes.resize(end, '\7');
    }
    return bytes;
  }

  /// Version 1.4, format 6, the 64-bit count alone.
  [[nodiscard]] static LasBytes version_1_4() {
    LasBytes las;
    las.minor = 4;
    las.header_bytes = 375;
    las.points_at = 375;
    las.format = 6;
    las.point_bytes = 30;
    las.old_count = 0;
    las.count = 2;
    return las;
  }
};

/// A variable length record: 54 bytes of header and `payload`.
inline std::string las_record(const std::string& payload) {
  std::string bytes(20, '\0');
  put(bytes, static_cast<std::uint16_t>(payload.size()));
  bytes.resize(54, '\0');
  return bytes + payload;
}

}  // namespace kilter_testing
