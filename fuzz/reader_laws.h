// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "kilter/base/expected.h"
#include "kilter/geometry/point_cloud.h"

namespace kilter_fuzz {

/// Stops the fuzzer with a stack trace, in every build type.
inline void demand(bool law_holds) {
  if (!law_holds) std::abort();
}

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// An error names its place and can be printed on any terminal, whatever the file held.
inline void demand_printable(const kilter::Error& error) {
  demand(error.where.starts_with("fuzz") && !error.message.empty());
  for (const char c : kilter::to_string(error)) {
    const auto byte = static_cast<unsigned char>(c);
    demand((byte >= 0x20 || c == '\n') && byte != 0x7F);
  }
}

/// A cloud holds only points that a lidar can have seen, and no more than its bytes can.
inline void demand_usable(const kilter::Expected<kilter::PointCloud>& cloud, std::size_t file_bytes) {
  if (!cloud) return demand_printable(cloud.error());
  for (const Eigen::Vector3f& point_m : cloud->points_m) {
    demand(point_m.cwiseAbs().maxCoeff() <= kilter::PointCloud::kMaxCoordinate_m);
  }
  // Three one-byte coordinates a point, 88 times denser when compressed.
  demand(cloud->points_m.size() + cloud->dropped_far + cloud->dropped_nonfinite <= 88 * file_bytes / 3);
}

}  // namespace kilter_fuzz
