// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/las_reader.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <optional>

#include "kilter/io/byte_cursor.h"
#include "kilter/io/number_text.h"
#include "kilter/io/scalar.h"

namespace kilter {
namespace {

constexpr std::string_view kSignature = "LASF";
constexpr std::size_t kHeaderBytes = 227;    // of versions 1.0 to 1.2; later ones add to it
constexpr std::size_t kHeader14Bytes = 375;  // with the 64-bit count
constexpr std::size_t kRecordHeaderBytes = 54;
constexpr unsigned kCompressedBits = 0xC0;  // set in the point format by LASzip
// The fewest bytes of a point, by format. More are the writer's own.
constexpr std::array<std::size_t, 11> kPointBytes = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

// What is needed of the public header block.
struct LasHeader {
  unsigned minor = 0;
  std::size_t header_bytes = 0;
  std::size_t points_at = 0;
  std::uint32_t records = 0;  // variable length ones, between header and points
  unsigned format = 0;
  std::size_t point_bytes = 0;
  std::uint64_t points = 0;
  std::array<double, 3> scale{};
  std::array<double, 3> offset_m{};
};

// Fields lie at fixed places. \pre `at` + sizeof(T) bytes are there.
template <typename T>
T field(std::string_view bytes, std::size_t at) {
  return load<T>(bytes.data() + at, std::endian::little);
}

Expected<void> check_kind(std::string_view bytes, const std::string& where) {
  if (bytes.empty()) return fail(ErrorCode::kTruncated, "the file is empty", where);
  if (!bytes.starts_with(kSignature.substr(0, bytes.size()))) {
    return fail(ErrorCode::kParse,
                fmt::format("expected \"LASF\" at the start, found \"{}\"", printable(bytes.substr(0, 4), 4)), where);
  }
  if (bytes.size() < kHeaderBytes) {
    return fail(ErrorCode::kTruncated,
                fmt::format("a LAS header has {} bytes, the file only {}", kHeaderBytes, bytes.size()), where);
  }
  const unsigned major = field<std::uint8_t>(bytes, 24);
  const unsigned minor = field<std::uint8_t>(bytes, 25);
  if (major == 1 && minor <= 4) return {};
  return fail(ErrorCode::kUnsupported, fmt::format("LAS version {}.{}, expected 1.0 to 1.4", major, minor), where);
}

Expected<void> check_format(const LasHeader& header, const std::string& where) {
  if ((header.format & kCompressedBits) != 0) {
    return fail(ErrorCode::kUnsupported, "its points are compressed (LAZ), whatever its name says", where,
                "decompress it: `laszip -i IN.laz -o OUT.las`, or `pdal translate IN.laz OUT.las`");
  }
  if (header.format >= kPointBytes.size()) {
    return fail(ErrorCode::kUnsupported, fmt::format("point format {}, expected 0 to 10", header.format), where);
  }
  if (header.point_bytes < kPointBytes[header.format]) {
    return fail(ErrorCode::kParse,
                fmt::format("a point of format {} has at least {} bytes, the header says {}", header.format,
                            kPointBytes[header.format], header.point_bytes),
                where);
  }
  return {};
}

// Version 1.4 has a count of 64 bits; the old one is then the same, or 0 where it could not hold it.
// \pre the header of that version is there
Expected<std::uint64_t> count_points(std::string_view bytes, unsigned minor, const std::string& where) {
  const std::uint64_t old_count = field<std::uint32_t>(bytes, 107);
  if (minor < 4) return old_count;
  const auto count = field<std::uint64_t>(bytes, 247);
  if (old_count == 0 || old_count == count) return count;
  if (count == 0) return old_count;
  return fail(ErrorCode::kCountMismatch,
              fmt::format("the header promises {} points, and {} where older readers look", count, old_count), where);
}

Expected<LasHeader> read_header(std::string_view bytes, const std::string& where) {
  if (auto ok = check_kind(bytes, where); !ok) return pass_up(ok.error());
  LasHeader header;
  header.minor = field<std::uint8_t>(bytes, 25);
  header.header_bytes = field<std::uint16_t>(bytes, 94);
  header.points_at = field<std::uint32_t>(bytes, 96);
  header.records = field<std::uint32_t>(bytes, 100);
  header.format = field<std::uint8_t>(bytes, 104);
  header.point_bytes = field<std::uint16_t>(bytes, 105);
  const std::size_t least = header.minor >= 4 ? kHeader14Bytes : kHeaderBytes;
  if (header.header_bytes < least || header.points_at < header.header_bytes) {
    return fail(ErrorCode::kParse,
                fmt::format("the header of version 1.{} has at least {} bytes and points come after it; it says {} "
                            "bytes, and points at byte {}",
                            header.minor, least, header.header_bytes, header.points_at),
                where);
  }
  if (header.points_at > bytes.size()) {
    return fail(ErrorCode::kTruncated,
                fmt::format("points begin at byte {}, the file has {}", header.points_at, bytes.size()), where);
  }
  if (auto ok = check_format(header, where); !ok) return pass_up(ok.error());
  const auto points = count_points(bytes, header.minor, where);
  if (!points) return pass_up(points.error());
  header.points = *points;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    header.scale[axis] = field<double>(bytes, 131 + 8 * axis);
    header.offset_m[axis] = field<double>(bytes, 155 + 8 * axis);
    if (std::isfinite(header.scale[axis]) && header.scale[axis] != 0.0 && std::isfinite(header.offset_m[axis]))
      continue;
    return fail(ErrorCode::kParse,
                fmt::format("scale {} and offset {} of axis {} make no coordinates", header.scale[axis],
                            header.offset_m[axis], axis),
                where);
  }
  return header;
}

// Variable length records say how long they are; all of them lie before the points.
Expected<void> skip_records(std::string_view bytes, const LasHeader& header, const std::string& where) {
  ByteCursor cursor(bytes.substr(header.header_bytes, header.points_at - header.header_bytes));
  for (std::uint32_t i = 0; i < header.records; ++i) {
    const auto record = cursor.take(kRecordHeaderBytes);
    if (record && cursor.take(field<std::uint16_t>(*record, 20))) continue;
    return fail(ErrorCode::kTruncated,
                fmt::format("the header promises {} variable length records, but number {} reaches beyond byte {}, "
                            "where points begin",
                            header.records, i, header.points_at),
                where);
  }
  return {};
}

Expected<std::string_view> points_of(std::string_view bytes, const LasHeader& header, const std::string& where) {
  const std::string_view rest = bytes.substr(header.points_at);
  const auto total = checked_product(header.points, header.point_bytes);
  if (total && *total <= rest.size()) return rest.substr(0, *total);
  return fail(ErrorCode::kTruncated,
              fmt::format("the header promises {} points of {} bytes, but only {} bytes follow ({} points)",
                          header.points, header.point_bytes, rest.size(), rest.size() / header.point_bytes),
              where);
}

std::array<double, 3> point_at(const char* record, const LasHeader& header) {
  std::array<double, 3> point_m{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto whole = load<std::int32_t>(record + 4 * axis, std::endian::little);
    point_m[axis] = whole * header.scale[axis] + header.offset_m[axis];
  }
  return point_m;
}

}  // namespace

Expected<std::uint64_t> read_las_count(std::string_view head, const std::string& where) {
  if (auto ok = check_kind(head, where); !ok) return pass_up(ok.error());
  const unsigned minor = field<std::uint8_t>(head, 25);
  if (minor >= 4 && head.size() < kHeader14Bytes) return fail(ErrorCode::kTruncated, "the header is cut short", where);
  return count_points(head, minor, where);
}

Expected<PointCloud> read_las(std::string_view bytes, const std::string& where) {
  const Expected<LasHeader> header = read_header(bytes, where);
  if (!header) return pass_up(header.error());
  if (auto ok = skip_records(bytes, *header, where); !ok) return pass_up(ok.error());
  const Expected<std::string_view> table = points_of(bytes, *header, where);
  if (!table) return pass_up(table.error());
  PointCloud cloud;
  cloud.points_m.reserve(header->points);
  for (std::size_t i = 0; i < header->points; ++i) {
    add_point(cloud, point_at(table->data() + i * header->point_bytes, *header));
  }
  if (header->points == 0 || !cloud.points_m.empty()) return cloud;
  const auto [x, y, z] = point_at(table->data(), *header);
  return fail(ErrorCode::kInvalidPoints,
              fmt::format("all {} points lie beyond {} m from the origin, the first at {:.1f} {:.1f} {:.1f}",
                          header->points, PointCloud::kMaxCoordinate_m, x, y, z),
              where,
              fmt::format("a georeferenced cloud? subtract an offset, say {:.0f} {:.0f} {:.0f}, and add it to its pose",
                          std::floor(x / 100.0) * 100.0, std::floor(y / 100.0) * 100.0, std::floor(z / 100.0) * 100.0));
}

}  // namespace kilter
