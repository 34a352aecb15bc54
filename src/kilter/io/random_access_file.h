// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "kilter/base/expected.h"
#include "kilter/io/file.h"
#include "kilter/io/open_file.h"

namespace kilter {

/// A file of any size that is read piece by piece and never held whole. Bytes are copied, never mapped: a file that
/// changes meanwhile cannot harm us.
class RandomAccessFile {
 public:
  /// \return  an open regular file; or kNotFound, kIo.
  [[nodiscard]] static Expected<RandomAccessFile> open(const std::filesystem::path& path);

  /// Bytes in memory that stand for a file. \pre they outlive it.
  [[nodiscard]] static RandomAccessFile over(std::string_view bytes, std::string where);

  /// Bytes in the file when it was opened.
  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// The file's name, for messages.
  [[nodiscard]] const std::string& where() const { return where_; }

  /// Copies bytes [offset, offset + size). May be called from several threads at once.
  /// \return  kTruncated (fewer bytes are there), kIo.
  [[nodiscard]] Expected<void> read_at(std::uint64_t offset, char* into, std::size_t size) const;

  /// The same into a new buffer; nothing is allocated for bytes that are not there. \return besides, kOutOfMemory.
  [[nodiscard]] Expected<ByteBuffer> read(std::uint64_t offset, std::uint64_t size) const;

 private:
  RandomAccessFile(std::optional<Descriptor> file, std::string_view bytes, std::uint64_t size, std::string where)
      : file_(std::move(file)), bytes_(bytes), size_(size), where_(std::move(where)) {}

  std::optional<Descriptor> file_;  // absent over memory
  std::string_view bytes_;
  std::uint64_t size_;
  std::string where_;
};

/// "run.bag: byte 4096".
[[nodiscard]] std::string at_byte(const std::string& where, std::uint64_t offset);

/// A part of a file, or bytes in memory, looked at in pieces: small ones share one read of the file.
class ByteWindow {
 public:
  /// Bytes [begin, end) of a file, at positions counted in the file. \pre begin <= end <= file.size(); it outlives this
  ByteWindow(const RandomAccessFile& file, std::uint64_t begin, std::uint64_t end)
      : file_(&file), where_(file.where()), begin_(begin), end_(end) {}
  /// Bytes in memory, at positions from 0. \pre they outlive this
  ByteWindow(std::string_view bytes, std::string where) : where_(std::move(where)), end_(bytes.size()), held_(bytes) {}

  [[nodiscard]] std::uint64_t begin() const { return begin_; }
  [[nodiscard]] std::uint64_t end() const { return end_; }
  /// The place of a position, for messages.
  [[nodiscard]] std::string where(std::uint64_t position) const { return at_byte(where_, position); }
  /// Whether [position, position + size) lies inside. No sum wraps.
  [[nodiscard]] bool holds(std::uint64_t position, std::uint64_t size) const {
    return position >= begin_ && position <= end_ && size <= end_ - position;
  }

  /// Bytes [position, position + size), valid until the next look.
  /// \return  kTruncated (not all of them lie inside; nothing is read or allocated then), kIo, kOutOfMemory.
  [[nodiscard]] Expected<std::string_view> look(std::uint64_t position, std::uint64_t size);

 private:
  const RandomAccessFile* file_ = nullptr;  // absent over memory
  std::string where_;
  std::uint64_t begin_ = 0;
  std::uint64_t end_ = 0;
  std::string_view held_;  // what was read last, or all of the memory
  std::uint64_t held_at_ = 0;
  ByteBuffer buffer_;
};

}  // namespace kilter
