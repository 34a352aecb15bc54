// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/report/cloud_pcd.h"

#include <fmt/format.h>

#include <bit>
#include <cstdint>

namespace kilter {

std::string cloud_pcd(std::span<const Eigen::Vector3f> points_m) {
  std::string bytes = fmt::format(
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
      "WIDTH {0}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {0}\nDATA binary\n",
      points_m.size());
  bytes.reserve(bytes.size() + points_m.size() * 3 * sizeof(float));
  for (const Eigen::Vector3f& point_m : points_m) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto word = std::bit_cast<std::uint32_t>(point_m[axis]);
      for (unsigned shift = 0; shift < 32; shift += 8) bytes += static_cast<char>((word >> shift) & 0xFF);
    }
  }
  return bytes;
}

}  // namespace kilter
