// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/decompress.h"

#include <bzlib.h>
#include <fmt/format.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>

namespace kilter {
namespace {

// Each returns how many bytes it wrote, or what is wrong; none writes beyond `into`.
struct Unpacked {
  std::uint64_t bytes = 0;
  std::string fault;
};

Unpacked unpack_bz2(std::string_view packed, ByteBuffer& into) {
  // Both sizes fit: chunks of 2.0 bags have 32-bit sizes, and kMaxUnpackedBytes is less.
  if (packed.size() > std::numeric_limits<unsigned>::max()) return {0, "it is too large for bzip2"};
  auto size = static_cast<unsigned>(into.size());
  // The library takes what it only reads as writable.
  char* source = const_cast<char*>(packed.data());  // NOLINT(cppcoreguidelines-pro-type-const-cast)
  const int status = BZ2_bzBuffToBuffDecompress(into.data(), &size, source, static_cast<unsigned>(packed.size()), 0, 0);
  if (status == BZ_OK) return {size, {}};
  return {0, status == BZ_OUTBUFF_FULL ? "it holds more" : fmt::format("bzip2 says {}", status)};
}

Unpacked unpack_lz4(std::string_view packed, ByteBuffer& into) {
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION)) != 0) return {0, "no memory for LZ4"};
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(raw,
                                                                                     &LZ4F_freeDecompressionContext);
  std::uint64_t done = 0;
  while (true) {
    std::size_t room = into.size() - static_cast<std::size_t>(done);
    std::size_t taken = packed.size();
    const std::size_t hint = LZ4F_decompress(context.get(), into.data() + done, &room, packed.data(), &taken, nullptr);
    if (LZ4F_isError(hint) != 0) return {0, fmt::format("LZ4 says {}", LZ4F_getErrorName(hint))};
    done += room;
    packed.remove_prefix(taken);
    if (hint == 0) return {done, {}};
    if (taken == 0 && room == 0) return {0, done == into.size() ? "it holds more" : "it ends too early"};
  }
}

Unpacked unpack_zstd(std::string_view packed, ByteBuffer& into) {
  const std::size_t done = ZSTD_decompress(into.data(), into.size(), packed.data(), packed.size());
  if (ZSTD_isError(done) != 0) return {0, fmt::format("Zstandard says {}", ZSTD_getErrorName(done))};
  return {done, {}};
}

Unpacked unpack_into(Packing packing, std::string_view packed, ByteBuffer& into) {
  switch (packing) {
    case Packing::kBz2:
      return unpack_bz2(packed, into);
    case Packing::kLz4:
      return unpack_lz4(packed, into);
    case Packing::kZstd:
      return unpack_zstd(packed, into);
    case Packing::kNone:
      break;
  }
  const std::size_t size = std::min(packed.size(), into.size());
  std::memcpy(into.data(), packed.data(), size);
  return {packed.size(), {}};
}

}  // namespace

Expected<ByteBuffer> unpack(Packing packing, std::string_view packed, std::uint64_t unpacked_bytes,
                            const std::string& where) {
  if (unpacked_bytes > most_unpacked(packed.size())) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("{} packed bytes claim to hold {}; of so few at most {} are unpacked", packed.size(),
                            unpacked_bytes, most_unpacked(packed.size())),
                where);
  }
  Expected<ByteBuffer> bytes = ByteBuffer::allocate(static_cast<std::size_t>(unpacked_bytes));
  if (!bytes) {
    bytes.error().where = where;
    return bytes;
  }
  const Unpacked unpacked = unpack_into(packing, packed, *bytes);
  if (!unpacked.fault.empty()) {
    return fail(ErrorCode::kParse, fmt::format("the packed data are damaged: {}", printable(unpacked.fault, 80)),
                where);
  }
  if (unpacked.bytes != unpacked_bytes) {
    return fail(ErrorCode::kParse,
                fmt::format("{} bytes are promised, {} come out of the packed data", unpacked_bytes, unpacked.bytes),
                where);
  }
  return bytes;
}

bool is_zstd_frame(std::string_view bytes) { return bytes.starts_with("\x28\xB5\x2F\xFD"); }

Expected<ByteBuffer> unpack_zstd_frame(std::string_view packed, const std::string& where) {
  const unsigned long long size = ZSTD_getFrameContentSize(packed.data(), packed.size());
  if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN) {
    return fail(ErrorCode::kUnsupported, "a message packed with Zstandard does not say its size", where);
  }
  return unpack(Packing::kZstd, packed, size, where);
}

}  // namespace kilter
