// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bin_reader.h"

#include <fmt/format.h>

#include <bit>

#include "kilter/io/scalar.h"

namespace kilter {
namespace {

constexpr std::size_t kRecordBytes = 16;
constexpr float kBelowAnyIntensity = -1.0F;
constexpr std::size_t kFewestOdd = 20;
constexpr std::size_t kOddShare = 20;  // one in so many

// Records whose fourth number is no intensity. Where records are of 12, 20 or 24 bytes, read as 16 bytes each, it is a
// coordinate every few points.
std::size_t count_odd_intensities(std::string_view bytes) {
  std::size_t odd = 0;
  for (std::size_t at = 12; at < bytes.size(); at += kRecordBytes) {
    odd += load<float>(bytes.data() + at, std::endian::little) < kBelowAnyIntensity ? 1 : 0;
  }
  return odd;
}

}  // namespace

Expected<PointCloud> read_bin(std::string_view bytes, const std::string& where) {
  if (bytes.empty()) return fail(ErrorCode::kTruncated, "the file is empty", where);
  if (bytes.size() % kRecordBytes != 0) {
    return fail(ErrorCode::kTruncated,
                fmt::format("{} bytes are {} points of 16 bytes and {} bytes more", bytes.size(),
                            bytes.size() / kRecordBytes, bytes.size() % kRecordBytes),
                where, "a .bin scan is float32 x y z intensity per point; save other layouts as .pcd or .ply");
  }
  const std::size_t points = bytes.size() / kRecordBytes;
  if (const std::size_t odd = count_odd_intensities(bytes); odd >= kFewestOdd && kOddShare * odd >= points) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("the fourth number of {} of {} records is below -1, as no intensity is: points seem not to "
                            "be of 16 bytes",
                            odd, points),
                where, "a .bin scan is float32 x y z intensity per point; save other layouts as .pcd or .ply");
  }
  PointCloud cloud;
  const PointColumns columns = {CoordinateColumn{bytes.data(), kRecordBytes, ScalarType::kFloat32},
                                CoordinateColumn{bytes.data() + 4, kRecordBytes, ScalarType::kFloat32},
                                CoordinateColumn{bytes.data() + 8, kRecordBytes, ScalarType::kFloat32}};
  add_points(cloud, points, columns, std::endian::little);
  return cloud;
}

}  // namespace kilter
