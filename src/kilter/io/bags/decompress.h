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

/// A chunk that claims to unpack to more is refused: recorders cut chunks at some MB, and a larger one holds a single
/// message.
inline constexpr std::uint64_t kMaxUnpackedBytes = std::uint64_t{1} << 30;

/// So is one that claims more than this many times its packed size: LZ4 cannot exceed 255, and no recording that holds
/// clouds comes near.
inline constexpr std::uint64_t kMaxUnpackedRatio = 1000;

/// What unpacks to less than this is never refused for its ratio.
inline constexpr std::uint64_t kFreeUnpackedBytes = std::uint64_t{1} << 16;

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
