// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/pcd_reader.h"

#include <fmt/format.h>
#include <liblzf/lzf.h>

#include <algorithm>
#include <bit>
#include <optional>

#include "kilter/io/byte_cursor.h"
#include "kilter/io/file.h"
#include "kilter/io/number_text.h"
#include "kilter/io/packed_points.h"
#include "kilter/io/pcd_header.h"
#include "kilter/io/random_access_file.h"
#include "kilter/io/text_points.h"

namespace kilter {
namespace {

// A back reference of 3 bytes yields at most 264.
constexpr std::uint64_t kMaxLzfRatio = 88;

// Fields other than x, y and z may pack as well as that, and are thrown away; but points take three packed bytes and
// more each, and few are larger than 64 when unpacked.
constexpr std::uint64_t kMostLzfRatio = 24;
constexpr std::uint64_t kFreeLzfBytes = std::uint64_t{64} << 20;

Expected<PointCloud> read_ascii(ByteCursor& bytes, const PcdHeader& header, const std::string& where) {
  const TextPointLayout layout = {
      .columns = header.columns,
      .xyz = {header.fields[header.xyz[0]].first_column, header.fields[header.xyz[1]].first_column,
              header.fields[header.xyz[2]].first_column}};
  Expected<PointCloud> cloud = read_text_points(bytes, header.points, layout, where);
  if (cloud && !skip_blank_lines(bytes)) {
    return fail(ErrorCode::kCountMismatch,
                fmt::format("the header promises {} points, but more lines follow", header.points),
                fmt::format("{}:{}", where, bytes.line() + 1));
  }
  return cloud;
}

// Records are looked at in blocks that stay in a processor's cache, so that a file need not be held whole beside its
// points: touching memory for the first time takes longer than all else here.
constexpr std::uint64_t kBlockBytes = 128 * 1024;

Expected<bool> is_padding_from(ByteWindow& window, std::uint64_t position) {
  while (position < window.end()) {
    const std::uint64_t size = std::min(kBlockBytes, window.end() - position);
    const auto bytes = window.look(position, size);
    if (!bytes) return pass_up(bytes.error());
    if (!is_padding(*bytes)) return false;
    position += size;
  }
  return true;
}

Expected<void> check_size(ByteWindow& window, std::uint64_t begin, const PcdHeader& header, const std::string& where) {
  const std::uint64_t left = window.end() - begin;
  const std::uint64_t stored = left / header.record_bytes;
  if (stored < header.points) {
    return fail(ErrorCode::kTruncated,
                fmt::format("the header promises {} points of {} bytes, but only {} bytes follow it ({} points)",
                            header.points, header.record_bytes, left, stored),
                where);
  }
  if (stored == header.points) return {};
  const auto padded = is_padding_from(window, begin + header.points * header.record_bytes);
  if (!padded) return pass_up(padded.error());
  if (*padded) return {};
  return fail(ErrorCode::kCountMismatch,
              fmt::format("the header promises {} points of {} bytes, but {} bytes follow it ({} points)",
                          header.points, header.record_bytes, left, stored),
              where);
}

// \param begin  where the window's first record lies
Expected<PointCloud> read_binary(ByteWindow& window, std::uint64_t begin, const PcdHeader& header,
                                 const std::string& where) {
  if (auto fits = check_size(window, begin, header, where); !fits) return pass_up(fits.error());
  PointCloud cloud;
  reserve_points(cloud, static_cast<std::size_t>(header.points));
  const std::uint64_t at_once = std::max<std::uint64_t>(1, kBlockBytes / header.record_bytes);
  for (std::uint64_t done = 0; done < header.points;) {
    const std::uint64_t here = std::min(at_once, header.points - done);
    const auto records = window.look(begin + done * header.record_bytes, here * header.record_bytes);
    if (!records) return pass_up(records.error());
    PointColumns columns;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const PcdField& field = header.fields[header.xyz[axis]];
      columns[axis] = {records->data() + field.offset, header.record_bytes, field.type};
    }
    add_points(cloud, static_cast<std::size_t>(here), columns, std::endian::little);
    done += here;
  }
  return cloud;
}

// The two sizes in front of the compressed block, made sure of before anything is allocated.
struct CompressedBlock {
  std::string_view packed;
  std::uint32_t unpacked_bytes = 0;
};

Expected<CompressedBlock> take_block(ByteCursor& bytes, const PcdHeader& header, const std::string& where) {
  const std::optional<std::string_view> sizes = bytes.take(8);
  if (!sizes) return fail(ErrorCode::kTruncated, "the file ends before the sizes of its compressed data", where);
  const auto packed_bytes = load<std::uint32_t>(sizes->data(), std::endian::little);
  const auto unpacked_bytes = load<std::uint32_t>(sizes->data() + 4, std::endian::little);
  const auto expected = checked_product(header.points, header.record_bytes);
  if (!expected || *expected != unpacked_bytes) {
    return fail(ErrorCode::kCountMismatch,
                fmt::format("{} points of {} bytes do not make the {} bytes that the compressed data claim to hold",
                            header.points, header.record_bytes, unpacked_bytes),
                where);
  }
  const std::size_t left = bytes.remaining();
  const std::optional<std::string_view> packed = bytes.take(packed_bytes);
  if (!packed) {
    return fail(ErrorCode::kTruncated,
                fmt::format("{} bytes of compressed data are promised, {} are there", packed_bytes, left), where);
  }
  if (unpacked_bytes > kMaxLzfRatio * packed_bytes) {
    return fail(ErrorCode::kParse,
                fmt::format("{} bytes of LZF data cannot hold the {} that are claimed", packed_bytes, unpacked_bytes),
                where);
  }
  const std::uint64_t most = std::max(kFreeLzfBytes, kMostLzfRatio * packed_bytes);
  if (unpacked_bytes > most) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("{} packed bytes claim to hold {}; of so few at most {} are unpacked", packed_bytes,
                            unpacked_bytes, most),
                where, "write it without compression, or without the fields that kilter does not read");
  }
  if (auto ok = check_packed_points(header.points, packed_bytes, where); !ok) return pass_up(ok.error());
  return CompressedBlock{*packed, unpacked_bytes};
}

Expected<PointCloud> read_compressed(ByteCursor& bytes, const PcdHeader& header, const std::string& where) {
  const Expected<CompressedBlock> block = take_block(bytes, header, where);
  if (!block) return pass_up(block.error());
  Expected<ByteBuffer> unpacked = ByteBuffer::allocate(block->unpacked_bytes);
  if (!unpacked) return pass_up(unpacked.error());
  const unsigned done = lzf_decompress(block->packed.data(), static_cast<unsigned>(block->packed.size()),
                                       unpacked->data(), block->unpacked_bytes);
  if (done != block->unpacked_bytes) {
    return fail(ErrorCode::kParse,
                fmt::format("the compressed data are damaged: LZF expands {} bytes to {}, not to {}",
                            block->packed.size(), done, block->unpacked_bytes),
                where);
  }
  PointColumns columns;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    // One block per field, so what lies before z is every point's x and y.
    const PcdField& field = header.fields[header.xyz[axis]];
    columns[axis] = {unpacked->data() + field.offset * header.points, size_of(field.type), field.type};
  }
  PointCloud cloud;
  add_points(cloud, header.points, columns, std::endian::little);
  return cloud;
}

}  // namespace

Expected<PointCloud> read_pcd(std::string_view bytes, const std::string& where) {
  ByteCursor cursor(without_byte_order_mark(bytes));
  const Expected<PcdHeader> header = read_pcd_header(cursor, where);
  if (!header) return pass_up(header.error());
  switch (header->data) {
    case PcdData::kAscii:
      return read_ascii(cursor, *header, where);
    case PcdData::kBinary: {
      ByteWindow window(cursor.rest(), where);
      return read_binary(window, 0, *header, where);
    }
    case PcdData::kBinaryCompressed:
      if (header->points == 0) return PointCloud{};  // writers differ in what they put after it
      return read_compressed(cursor, *header, where);
  }
  return PointCloud{};
}

Expected<PointCloud> read_pcd_file(const std::filesystem::path& path) {
  constexpr std::uint64_t kHead = 8192;  // headers are a few hundred bytes
  const Expected<RandomAccessFile> file = RandomAccessFile::open(path);
  if (!file) return pass_up(file.error());
  const std::string where = shown(path);
  if (file->size() > kHead && file->size() <= kMaxFileBytes) {
    const Expected<ByteBuffer> head = file->read(0, kHead);
    if (!head) return pass_up(head.error());
    const std::string_view text = without_byte_order_mark(head->view());
    ByteCursor cursor(text);
    const Expected<PcdHeader> header = read_pcd_header(cursor, where);
    if (header && header->data == PcdData::kBinary) {
      ByteWindow window(*file, 0, file->size());
      return read_binary(window, head->size() - text.size() + cursor.position(), *header, where);
    }
  }
  const Expected<ByteBuffer> bytes = read_file(path);
  if (!bytes) return pass_up(bytes.error());
  return read_pcd(bytes->view(), where);
}

}  // namespace kilter
