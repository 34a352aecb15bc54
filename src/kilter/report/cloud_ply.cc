// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/report/cloud_ply.h"

#include <bit>
#include <cstdint>

#include <fmt/format.h>

#include "kilter/base/expected.h"

namespace kilter {

std::string cloud_ply(std::span<const Eigen::Vector3f> points_m, const Pose3& T_frame_points, std::string_view frame) {
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment frame {}, metres\nelement vertex {}\n"
      "property float x\nproperty float y\nproperty float z\nend_header\n",
      printable(std::string(frame)), points_m.size());
  bytes.reserve(bytes.size() + points_m.size() * 3 * sizeof(float));
  const Eigen::Isometry3d T = T_frame_points.isometry();
  for (const Eigen::Vector3f& point_m : points_m) {
    const Eigen::Vector3f moved_m = (T * point_m.cast<double>()).cast<float>();
    for (int axis = 0; axis < 3; ++axis) {
      const auto word = std::bit_cast<std::uint32_t>(moved_m[axis]);
      for (unsigned shift = 0; shift < 32; shift += 8) bytes += static_cast<char>((word >> shift) & 0xFF);
    }
  }
  return bytes;
}

}  // namespace kilter
