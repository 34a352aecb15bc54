// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "kilter/base/expected.h"
#include "kilter/io/file.h"

namespace kilter {

/// How a bag's chunk is packed.
enum class Packing { kNone, kBz2, kLz4, kZstd };

/// What a chunk may claim to unpack to: at most this many times its packed size (LZ4 cannot exceed 255, and no
/// recording that holds clouds comes near), where that is more than a page or so ...
inline constexpr std::uint64_t kMaxUnpackedRatio = 1000;
inline constexpr std::uint64_t kFreeUnpackedBytes = std::uint64_t{1} << 16;

/// ... and at most 128 MiB and three times its packed size, never more than 1 GiB: recorders cut chunks at some MB, and
/// a larger one holds a single message. So a file's size bounds the memory that it can take.
inline constexpr std::uint64_t kMaxUnpackedBytes = std::uint64_t{1} << 30;
[[nodiscard]] constexpr std::uint64_t most_unpacked(std::uint64_t packed_bytes) {
  const std::uint64_t packed = packed_bytes < kMaxUnpackedBytes ? packed_bytes : kMaxUnpackedBytes;
  const std::uint64_t by_ratio = kMaxUnpackedRatio * packed;
  const std::uint64_t by_size = (std::uint64_t{1} << 27) + 3 * packed;
  const std::uint64_t most = by_ratio < kFreeUnpackedBytes ? kFreeUnpackedBytes
                             : by_ratio < by_size          ? by_ratio
                                                           : by_size;
  return most < kMaxUnpackedBytes ? most : kMaxUnpackedBytes;
}

/// bzip2 unpacks 10 to 100 MB a second: the packed chunks of one file that are looked into may claim 16 MiB and a
/// hundred times the file's size together. Clouds hardly shrink to less than a third.
[[nodiscard]] constexpr std::uint64_t most_of_bz2(std::uint64_t file_bytes) {
  return (std::uint64_t{1} << 24) + 100 * file_bytes;
}

/// All that is unpacked of one file, however often, before it is given up: 512 MiB and 4,000 times its size, where
/// bzip2 counts ten times. Recordings in whatever order come to some dozens; a chunk beyond kMostHeldBytes that holds
/// thousands of clouds, and would be unpacked for each, does not. Every time counts, also where two threads unpack one
/// chunk at once, so that where exactly the bound is met depends on threads; what is far from it is not concerned.
inline constexpr std::uint64_t kTimesBz2IsSlower = 10;
[[nodiscard]] constexpr std::uint64_t most_unpacked_again(std::uint64_t file_bytes) {
  return (std::uint64_t{1} << 29) + 4000 * file_bytes;
}

/// Unpacks one chunk: a bzip2 stream, an LZ4 frame or a Zstandard frame.
///
/// \param unpacked_bytes  what the bag says that it unpacks to; it must do so exactly
/// \param where  for messages
/// \return  the bytes; or kUnsupported (more than the bounds above), kParse (damaged, or another size), kOutOfMemory.
/// Memory that is not written is not used, so that a lie costs nothing.
[[nodiscard]] Expected<ByteBuffer> unpack(Packing packing, std::string_view packed, std::uint64_t unpacked_bytes,
                                          const std::string& where);

/// Whether bytes begin as a Zstandard frame does: single messages of a bag may be packed so.
[[nodiscard]] bool is_zstd_frame(std::string_view bytes);

/// Unpacks a Zstandard frame that says its own size. \return as `unpack`; kUnsupported where it does not say.
[[nodiscard]] Expected<ByteBuffer> unpack_zstd_frame(std::string_view packed, const std::string& where);

}  // namespace kilter
