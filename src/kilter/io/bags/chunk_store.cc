// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/chunk_store.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>

#include "kilter/base/contract.h"

namespace kilter {
namespace {

// Neighbouring clouds share a chunk; a chunk larger than this holds but one.
constexpr std::size_t kHeldChunks = 4;
constexpr std::size_t kMaxHeldBytes = std::size_t{16} << 20;

std::uint32_t crc32_of(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), static_cast<z_size_t>(bytes.size())));
}

}  // namespace

std::uint32_t ChunkStore::add(const PackedChunk& chunk) {
  chunks_.push_back(chunk);
  return static_cast<std::uint32_t>(chunks_.size() - 1);
}

Expected<std::shared_ptr<const ByteBuffer>> ChunkStore::chunk(std::uint32_t number) const {
  KILTER_EXPECTS(number < chunks_.size());
  if (auto held = find_held(number)) return held;
  const PackedChunk& chunk = chunks_[number];
  const std::string where = where_of_chunk(number);
  const Expected<ByteBuffer> packed = file_.read(chunk.offset, chunk.packed_bytes);
  if (!packed) return pass_up(packed.error());
  Expected<ByteBuffer> bytes = unpack(chunk.packing, packed->view(), chunk.unpacked_bytes, where);
  if (!bytes) return pass_up(bytes.error());
  if (chunk.crc32 != 0 && crc32_of(bytes->view()) != chunk.crc32) {
    return fail(ErrorCode::kParse, "the chunk's checksum (CRC-32) is not that of its bytes: it is damaged", where);
  }
  auto shared = std::make_shared<const ByteBuffer>(*std::move(bytes));
  if (shared->size() <= kMaxHeldBytes) hold(number, shared);
  return shared;
}

Expected<MessageBytes> ChunkStore::read(const MessagePlace& place) const {
  if (place.chunk == MessagePlace::kNoChunk) {
    Expected<ByteBuffer> bytes = file_.read(place.offset, place.size);
    if (!bytes) return pass_up(bytes.error());
    auto owner = std::make_shared<const ByteBuffer>(*std::move(bytes));
    return MessageBytes{owner, owner->view(), owner->size()};
  }
  auto owner = chunk(place.chunk);
  if (!owner) return pass_up(owner.error());
  const std::string_view all = (*owner)->view();
  KILTER_EXPECTS(place.offset <= all.size() && place.size <= all.size() - place.offset);
  return MessageBytes{*owner, all.substr(static_cast<std::size_t>(place.offset), static_cast<std::size_t>(place.size)),
                      chunks_[place.chunk].packed_bytes};
}

std::string ChunkStore::where(const MessagePlace& place) const {
  if (place.chunk == MessagePlace::kNoChunk) return at_byte(file_.where(), place.offset);
  return at_byte(where_of_chunk(place.chunk), place.offset);
}

std::string ChunkStore::where_of_chunk(std::uint32_t number) const {
  return fmt::format("{}, unpacked chunk", at_byte(file_.where(), chunks_[number].offset));
}

std::shared_ptr<const ByteBuffer> ChunkStore::find_held(std::uint32_t number) const {
  const std::lock_guard lock(mutex_);
  const auto found = std::find_if(held_.begin(), held_.end(), [&](const Held& held) { return held.first == number; });
  return found == held_.end() ? nullptr : found->second;
}

void ChunkStore::hold(std::uint32_t number, const std::shared_ptr<const ByteBuffer>& bytes) const {
  const std::lock_guard lock(mutex_);
  held_.emplace_front(number, bytes);
  if (held_.size() > kHeldChunks) held_.pop_back();
}

}  // namespace kilter
