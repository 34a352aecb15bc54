// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/chunk_store.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>

#include "kilter/base/contract.h"

namespace kilter {
namespace {

// As long as one is found by walking through all.
constexpr std::size_t kMostHeldChunks = 256;

constexpr const char* kUnpackIt = "write the recording without compression";

std::uint32_t crc32_of(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), static_cast<z_size_t>(bytes.size())));
}

}  // namespace

Expected<std::uint32_t> ChunkStore::add(const PackedChunk& chunk) {
  const auto number = static_cast<std::uint32_t>(chunks_.size());
  chunks_.push_back(chunk);
  if (chunk.packing != Packing::kBz2) return number;
  const std::uint64_t most = most_of_bz2(file_.size());
  bz2_bytes_ += std::min(chunk.unpacked_bytes, kMaxUnpackedBytes);
  if (bz2_bytes_ <= most) return number;
  return fail(ErrorCode::kUnsupported,
              fmt::format("up to here bzip2 would unpack {} bytes; of a file of {} at most {} are unpacked", bz2_bytes_,
                          file_.size(), most),
              where_of_chunk(number), kUnpackIt);
}

// Chunks that were put out may be asked for again, for every cloud in them.
Expected<void> ChunkStore::charge(std::uint32_t number) const {
  const PackedChunk& chunk = chunks_[number];
  const std::uint64_t bytes = std::min(chunk.unpacked_bytes, most_unpacked(chunk.packed_bytes));
  const std::uint64_t cost = chunk.packing == Packing::kBz2 ? kTimesBz2IsSlower * bytes : bytes;
  const std::uint64_t before = charged_bytes_.fetch_add(cost);
  if (before <= most_unpacked_again(file_.size())) return {};
  return fail(ErrorCode::kUnsupported, "chunks have to be unpacked over and over, as they hold too much for memory",
              where_of_chunk(number), std::string(kUnpackIt) + ", or in chunks of some megabytes");
}

Expected<std::shared_ptr<const ByteBuffer>> ChunkStore::chunk(std::uint32_t number) const {
  KILTER_EXPECTS(number < chunks_.size());
  if (auto held = find_held(number)) return held;
  const PackedChunk& chunk = chunks_[number];
  if (auto ok = charge(number); !ok) return pass_up(ok.error());
  const std::string where = where_of_chunk(number);
  const Expected<ByteBuffer> packed = file_.read(chunk.offset, chunk.packed_bytes);
  if (!packed) return pass_up(packed.error());
  Expected<ByteBuffer> bytes = unpack(chunk.packing, packed->view(), chunk.unpacked_bytes, where);
  if (!bytes) return pass_up(bytes.error());
  if (chunk.crc32 != 0 && crc32_of(bytes->view()) != chunk.crc32) {
    return fail(ErrorCode::kParse, "the chunk's checksum (CRC-32) is not that of its bytes: it is damaged", where);
  }
  auto shared = std::make_shared<const ByteBuffer>(*std::move(bytes));
  hold(number, shared);
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
  if (found == held_.end()) return nullptr;
  held_.splice(held_.begin(), held_, found);
  return held_.front().second;
}

void ChunkStore::hold(std::uint32_t number, const std::shared_ptr<const ByteBuffer>& bytes) const {
  if (bytes->size() > kMostHeldBytes) return;
  const std::lock_guard lock(mutex_);
  const auto is_it = [&](const Held& held) { return held.first == number; };
  if (std::any_of(held_.begin(), held_.end(), is_it)) return;  // another thread was faster
  held_.emplace_front(number, bytes);
  held_bytes_ += bytes->size();
  for (; held_bytes_ > kMostHeldBytes || held_.size() > kMostHeldChunks; held_.pop_back()) {
    held_bytes_ -= held_.back().second->size();
  }
}

}  // namespace kilter
