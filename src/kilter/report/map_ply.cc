// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/report/map_ply.h"

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <fmt/format.h>

#include "kilter/base/expected.h"
#include "kilter/report/palette.h"

namespace kilter {
namespace {

constexpr std::size_t kBytesPerVoxel = 3 * sizeof(double) + 3 + sizeof(float);

template <typename Word>
void append_little_endian(std::string& bytes, Word word) {
  for (std::size_t i = 0; i < sizeof(Word); ++i) bytes += static_cast<char>((word >> (8 * i)) & 0xFF);
}

float probability(double log_odds) { return static_cast<float>(1.0 / (1.0 + std::exp(-log_odds))); }

}  // namespace

std::string map_ply(const FusedMap& map, const std::vector<RobotSummary>& robots) {
  std::string bytes =
      fmt::format("ply\nformat binary_little_endian 1.0\ncomment map {}, world frame, metres\n", printable(map.name));
  for (std::size_t robot = 0; robot < robots.size(); ++robot) {
    const auto [red, green, blue] = robot_colour(static_cast<int>(robot));
    bytes += fmt::format("comment robot {} {} {} {}\n", printable(robots[robot].name), red, green, blue);
  }
  bytes += fmt::format("element vertex {}\n", map.voxels.size());
  bytes += "property double x\nproperty double y\nproperty double z\n";
  bytes += "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float probability\nend_header\n";
  bytes.reserve(bytes.size() + map.voxels.size() * kBytesPerVoxel);
  for (const FusedVoxel& voxel : map.voxels) {
    for (int axis = 0; axis < 3; ++axis) {
      append_little_endian(bytes, std::bit_cast<std::uint64_t>(voxel.centroid_world_m[axis]));
    }
    for (const std::uint8_t channel : robot_colour(voxel.robot)) bytes += static_cast<char>(channel);
    append_little_endian(bytes, std::bit_cast<std::uint32_t>(probability(voxel.log_odds)));
  }
  return bytes;
}

}  // namespace kilter
