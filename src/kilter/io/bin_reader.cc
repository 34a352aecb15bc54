// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bin_reader.h"

#include <fmt/format.h>

#include <bit>

#include "kilter/io/scalar.h"

namespace kilter {

Expected<PointCloud> read_bin(std::string_view bytes, const std::string& where) {
  constexpr std::size_t kRecordBytes = 16;
  if (bytes.empty()) return fail(ErrorCode::kTruncated, "the file is empty", where);
  if (bytes.size() % kRecordBytes != 0) {
    return fail(ErrorCode::kTruncated,
                fmt::format("{} bytes are {} points of 16 bytes and {} bytes more", bytes.size(),
                            bytes.size() / kRecordBytes, bytes.size() % kRecordBytes),
                where, "a .bin scan is float32 x y z intensity per point; save other layouts as .pcd or .ply");
  }
  PointCloud cloud;
  const PointColumns columns = {CoordinateColumn{bytes.data(), kRecordBytes, ScalarType::kFloat32},
                                CoordinateColumn{bytes.data() + 4, kRecordBytes, ScalarType::kFloat32},
                                CoordinateColumn{bytes.data() + 8, kRecordBytes, ScalarType::kFloat32}};
  add_points(cloud, bytes.size() / kRecordBytes, columns, std::endian::little);
  return cloud;
}

}  // namespace kilter
