// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/cloud_file.h"

#include <algorithm>
#include <functional>

#include "kilter/io/bin_reader.h"
#include "kilter/io/byte_cursor.h"
#include "kilter/io/file.h"
#include "kilter/io/las_reader.h"
#include "kilter/io/number_text.h"
#include "kilter/io/pcd_header.h"
#include "kilter/io/pcd_reader.h"
#include "kilter/io/ply_header.h"
#include "kilter/io/ply_reader.h"
#include "kilter/io/random_access_file.h"

namespace kilter {
std::optional<CloudFormat> cloud_format_of(std::string_view file_name) {
  const std::size_t dot = file_name.rfind('.');
  if (dot == std::string_view::npos || dot == 0) return std::nullopt;
  const std::string extension = lower_case(file_name.substr(dot));
  if (extension == ".bin") return CloudFormat::kBin;
  if (extension == ".pcd") return CloudFormat::kPcd;
  if (extension == ".ply") return CloudFormat::kPly;
  if (extension == ".las") return CloudFormat::kLas;
  return std::nullopt;
}

std::optional<CloudPeek> peek_cloud_file(const std::filesystem::path& path) {
  constexpr std::size_t kHead = 8192;  // headers are a few hundred bytes
  constexpr std::uint64_t kBinRecord = 16;
  const Expected<RandomAccessFile> file = RandomAccessFile::open(path);
  if (!file) return std::nullopt;
  const Expected<ByteBuffer> head = file->read(0, std::min<std::uint64_t>(file->size(), kHead));
  if (!head) return std::nullopt;
  CloudPeek peek;
  peek.bytes = file->size();
  peek.head = std::hash<std::string_view>()(head->view());
  const std::optional<CloudFormat> format = cloud_format_of(path.filename().native());
  ByteCursor cursor(head->view());
  if (format == CloudFormat::kBin) {
    peek.points = peek.bytes / kBinRecord;
  } else if (format == CloudFormat::kPcd) {
    if (const auto header = read_pcd_header(cursor, shown(path))) peek.points = header->points;
  } else if (format == CloudFormat::kPly) {
    if (const auto header = read_ply_header(cursor, shown(path))) peek.points = header->elements[header->vertex].rows;
  } else if (format == CloudFormat::kLas) {
    if (const auto points = read_las_count(head->view(), shown(path))) peek.points = *points;
  }
  return peek;
}

Expected<PointCloud> read_cloud_file(const std::filesystem::path& path) {
  const std::optional<CloudFormat> format = cloud_format_of(path.filename().native());
  if (!format) return fail(ErrorCode::kUnsupported, "expected a .bin, .pcd, .ply or .las file", shown(path));
  if (*format == CloudFormat::kPcd) return read_pcd_file(path);
  const Expected<ByteBuffer> bytes = read_file(path);
  if (!bytes) return pass_up(bytes.error());
  switch (*format) {
    case CloudFormat::kBin:
      return read_bin(bytes->view(), shown(path));
    case CloudFormat::kPcd:
      return read_pcd(bytes->view(), shown(path));
    case CloudFormat::kPly:
      return read_ply(bytes->view(), shown(path));
    case CloudFormat::kLas:
      return read_las(bytes->view(), shown(path));
  }
  return PointCloud{};
}

}  // namespace kilter
