// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/report/coloured_ply.h"

#include <bit>
#include <cstddef>
#include <cstdint>

#include <fmt/format.h>

#include "kilter/base/expected.h"
#include "kilter/report/palette.h"

namespace kilter {
namespace {

constexpr double kMost_m = 254 * Picture::kMisalignmentStep_m;
constexpr std::size_t kBytesPerPoint = 3 * sizeof(double) + 3 + 3 * sizeof(std::uint32_t);

template <typename Word>
void append_little_endian(std::string& bytes, Word word) {
  for (std::size_t i = 0; i < sizeof(Word); ++i) bytes += static_cast<char>((word >> (8 * i)) & 0xFF);
}

std::string header(const Result& result, std::size_t points) {
  std::string text = "ply\nformat binary_little_endian 1.0\ncomment kilter, world frame, metres\n";
  text += fmt::format("comment misalignment {:.2f} is that or more, -1 none known\n", kMost_m);
  for (std::size_t i = 0; i < result.robots.size(); ++i) {
    text += fmt::format("comment robot {} {}\n", i, printable(result.robots[i].name));
  }
  for (std::size_t i = 0; i < result.submaps.size(); ++i) {
    text += fmt::format("comment submap {} {}\n", i, printable(result.submaps[i].name));
  }
  text += fmt::format("element vertex {}\n", points);
  text += "property double x\nproperty double y\nproperty double z\n";
  text += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  text += "property int robot\nproperty int submap\nproperty float misalignment\nend_header\n";
  return text;
}

}  // namespace

std::string coloured_ply(const Result& result, double tolerance_m) {
  std::size_t points = 0;
  for (const CloudPicture& cloud : result.picture->clouds) points += cloud.points.size();
  std::string bytes = header(result, points);
  bytes.reserve(bytes.size() + points * kBytesPerPoint);
  std::uint32_t robot = 0;
  for (std::size_t i = 0; i < result.submaps.size(); ++i) {
    // Submaps come robot by robot, in the robots' order.
    while (robot + 1 < result.robots.size() && result.robots[robot].name != result.submaps[i].robot) ++robot;
    const CloudPicture& cloud = result.picture->clouds[i];
    const Eigen::Isometry3d T = result.submaps[i].T_world_submap.isometry();
    for (std::size_t k = 0; k < cloud.points.size(); ++k) {
      const Eigen::Vector3d at_m = T * cloud.point_m(k);
      for (int axis = 0; axis < 3; ++axis) append_little_endian(bytes, std::bit_cast<std::uint64_t>(at_m[axis]));
      const std::uint8_t byte = cloud.misalignment[k];
      for (const std::uint8_t channel : misalignment_colour(byte, tolerance_m)) bytes += static_cast<char>(channel);
      append_little_endian(bytes, robot);
      append_little_endian(bytes, static_cast<std::uint32_t>(i));
      const double metres = byte == 0 ? -1.0 : (byte - 1) * Picture::kMisalignmentStep_m;
      append_little_endian(bytes, std::bit_cast<std::uint32_t>(static_cast<float>(metres)));
    }
  }
  return bytes;
}

}  // namespace kilter
