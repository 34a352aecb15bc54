// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/packed_points.h"

#include <fmt/format.h>

#include <algorithm>

namespace kilter {

Expected<void> check_packed_points(std::uint64_t points, std::uint64_t packed_bytes, const std::string& where) {
  const std::uint64_t most = std::max(kFreePackedPoints, kMostPointsAPackedByte * packed_bytes);
  if (points <= most) return {};
  return fail(ErrorCode::kUnsupported,
              fmt::format("{} packed bytes claim to hold {} points; of so few at most {} are unpacked, as points of a "
                          "lidar take three bytes and more each",
                          packed_bytes, points, most),
              where, "if they are meant, write them without compression");
}

}  // namespace kilter
