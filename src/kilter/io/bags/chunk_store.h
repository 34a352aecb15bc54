// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/io/bags/bag_reader.h"
#include "kilter/io/bags/decompress.h"
#include "kilter/io/random_access_file.h"

namespace kilter {

/// Where a packed chunk lies in its file.
struct PackedChunk {
  Packing packing = Packing::kNone;
  std::uint64_t offset = 0;  ///< of the packed bytes
  std::uint64_t packed_bytes = 0;
  std::uint64_t unpacked_bytes = 0;
  std::uint32_t crc32 = 0;  ///< of the unpacked bytes; 0 where the bag has none
};

/// So much of what was unpacked last stays in memory: neighbouring clouds share a chunk. A larger chunk does not, since
/// it mostly holds but one.
inline constexpr std::size_t kMostHeldBytes = std::size_t{32} << 20;

/// A bag's file, and its packed chunks as they are asked for. How much is unpacked is bounded by the file's size.
class ChunkStore {
 public:
  explicit ChunkStore(RandomAccessFile file) : file_(std::move(file)) {}

  [[nodiscard]] const RandomAccessFile& file() const { return file_; }

  /// \return the chunk's number, or kUnsupported: beyond most_of_bz2. Not while others read.
  [[nodiscard]] Expected<std::uint32_t> add(const PackedChunk& chunk);

  /// A chunk's bytes, unpacked. May be called from several threads at once.
  /// \return  kTruncated, kParse (damaged, or another checksum), kUnsupported (it claims too much,
  /// most_unpacked_again), kIo, kOutOfMemory.
  [[nodiscard]] Expected<std::shared_ptr<const ByteBuffer>> chunk(std::uint32_t number) const;

  /// A message's bytes from its chunk, or from the file where it is in none. As `chunk`.
  [[nodiscard]] Expected<MessageBytes> read(const MessagePlace& place) const;

  /// "run.bag: byte 4096", and where in the unpacked chunk.
  [[nodiscard]] std::string where(const MessagePlace& place) const;
  /// The same for a chunk.
  [[nodiscard]] std::string where_of_chunk(std::uint32_t number) const;

 private:
  using Held = std::pair<std::uint32_t, std::shared_ptr<const ByteBuffer>>;
  [[nodiscard]] Expected<void> charge(std::uint32_t number) const;
  [[nodiscard]] std::shared_ptr<const ByteBuffer> find_held(std::uint32_t number) const;
  void hold(std::uint32_t number, const std::shared_ptr<const ByteBuffer>& bytes) const;

  RandomAccessFile file_;
  std::vector<PackedChunk> chunks_;
  mutable std::mutex mutex_;
  std::uint64_t bz2_bytes_ = 0;  // that all chunks packed so claim
  mutable std::atomic<std::uint64_t> charged_bytes_ = 0;
  mutable std::list<Held> held_;  // latest first
  mutable std::size_t held_bytes_ = 0;
};

}  // namespace kilter
