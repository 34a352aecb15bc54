// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/cloud_file.h"

#include <algorithm>
#include <bit>
#include <functional>
#include <limits>

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
#include "kilter/io/scalar.h"

namespace kilter {
namespace {

constexpr std::uint64_t kHead = 8192;  // headers are a few hundred bytes

// What the beginning of a file says of the rest.
struct Promise {
  std::uint64_t points = 0;
  std::uint64_t least_bytes = 0;  // that a file with so many points has
};

// No file has so many.
std::uint64_t times(std::uint64_t count, std::uint64_t bytes) {
  return checked_product(count, bytes).value_or(std::numeric_limits<std::uint64_t>::max() / 2);
}

// Lines of text: a digit and what parts it from the next. The last line needs no end.
std::uint64_t text_bytes(std::uint64_t rows, std::uint64_t columns) {
  return rows == 0 || columns == 0 ? 0 : times(rows, 2 * columns) - 1;
}

Expected<Promise> promise_of_pcd(std::string_view head, const std::string& where) {
  ByteCursor cursor(head);
  const Expected<PcdHeader> header = read_pcd_header(cursor, where);
  if (!header) return pass_up(header.error());
  const std::uint64_t begin = cursor.position();
  switch (header->data) {
    case PcdData::kAscii:
      return Promise{header->points, begin + text_bytes(header->points, header->columns)};
    case PcdData::kBinary:
      return Promise{header->points, begin + times(header->points, header->record_bytes)};
    case PcdData::kBinaryCompressed:
      break;
  }
  if (header->points == 0) return Promise{0, begin};
  constexpr std::uint64_t kSizes = 8;  // packed, then unpacked
  const std::optional<std::string_view> sizes = cursor.take(kSizes);
  const std::uint64_t packed_bytes = sizes ? load<std::uint32_t>(sizes->data(), std::endian::little) : 0;
  return Promise{header->points, begin + kSizes + packed_bytes};
}

Expected<Promise> promise_of_ply(std::string_view head, const std::string& where) {
  ByteCursor cursor(head);
  const Expected<PlyHeader> header = read_ply_header(cursor, where);
  if (!header) return pass_up(header.error());
  const PlyElement& vertex = header->elements[header->vertex];
  if (vertex.has_lists()) return Promise{vertex.rows, cursor.position()};
  if (!header->is_ascii) return Promise{vertex.rows, cursor.position() + times(vertex.rows, vertex.row_bytes())};
  return Promise{vertex.rows, cursor.position() + text_bytes(vertex.rows, vertex.properties.size())};
}

Expected<Promise> promise_of_las(std::string_view head, const std::string& where) {
  const Expected<std::uint64_t> points = read_las_count(head, where);
  if (!points) return pass_up(points.error());
  return Promise{*points, 0};
}

// A .bin file promises nothing, it is its points.
Expected<Promise> promise_of_bin(std::uint64_t bytes) {
  constexpr std::uint64_t kRecord = 16;
  const std::uint64_t points = bytes / kRecord;
  return Promise{points, std::max<std::uint64_t>(1, (bytes + kRecord - 1) / kRecord) * kRecord};
}

Expected<Promise> promise_of(CloudFormat format, std::uint64_t bytes, std::string_view head, const std::string& where) {
  switch (format) {
    case CloudFormat::kBin:
      return promise_of_bin(bytes);
    case CloudFormat::kPcd:
      return promise_of_pcd(head, where);
    case CloudFormat::kPly:
      return promise_of_ply(head, where);
    case CloudFormat::kLas:
      return promise_of_las(head, where);
  }
  return Promise{};
}

}  // namespace

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
  const Expected<RandomAccessFile> file = RandomAccessFile::open(path);
  if (!file) return std::nullopt;
  const Expected<ByteBuffer> head = file->read(0, std::min(file->size(), kHead));
  if (!head) return std::nullopt;
  CloudPeek peek;
  peek.bytes = file->size();
  peek.head = std::hash<std::string_view>()(head->view());
  const std::optional<CloudFormat> format = cloud_format_of(path.filename().native());
  if (!format) return peek;
  const Expected<Promise> promise = promise_of(*format, peek.bytes, head->view(), shown(path));
  if (promise) {
    peek.points = promise->points;
    peek.is_cut_short = peek.bytes < promise->least_bytes;
  } else {
    // A header may be longer than what was looked at.
    peek.is_cut_short = peek.bytes <= kHead || promise.error().code != ErrorCode::kTruncated;
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
