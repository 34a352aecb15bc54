// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "kilter/base/expected.h"

namespace kilter {

/// A block of bytes that is not cleared before it is filled; what files are read and unpacked into.
class ByteBuffer {
 public:
  ByteBuffer() = default;

  /// \return `size` bytes of unspecified content, or kOutOfMemory.
  [[nodiscard]] static Expected<ByteBuffer> allocate(std::size_t size);

  [[nodiscard]] std::string_view view() const { return {data_.get(), size_}; }
  [[nodiscard]] char* data() { return data_.get(); }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  std::unique_ptr<char[]> data_;
  std::size_t size_ = 0;
};

/// Larger files are refused before a byte is read: a sparse file may claim any size.
inline constexpr std::uint64_t kMaxFileBytes = std::uint64_t{1} << 35;

/// Reads a whole regular file. The bytes are copied, never mapped: a file that changes meanwhile cannot harm us.
///
/// \return  the bytes, or kNotFound, kIo (not a regular file, not readable), kTruncated (it shrank while being
///          read), kUnsupported (larger than `max_bytes`), kOutOfMemory.
[[nodiscard]] Expected<ByteBuffer> read_file(const std::filesystem::path& path,
                                             std::uint64_t max_bytes = kMaxFileBytes);

/// Writes beside the final name, syncs, and renames into place: whoever finds `path` finds all of `bytes` or what was
/// there before. A symlink at `path` is replaced, not followed. The folder must exist.
///
/// \return  kNoSpace (disk, quota or file size limit), kIo for anything else; nothing is left behind then.
[[nodiscard]] Expected<void> write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

/// Names of a folder's entries, sorted bytewise; "." and ".." left out. \return kNotFound, kIo.
[[nodiscard]] Expected<std::vector<std::string>> list_folder(const std::filesystem::path& folder);

/// Whether a folder, or a file, stands there; links are followed, and one to nothing is neither.
[[nodiscard]] bool is_folder(const std::filesystem::path& path);
[[nodiscard]] bool is_file(const std::filesystem::path& path);

/// Makes names in a folder outlive a power cut. One that cannot be synced is no reason to fail.
void sync_folder(const std::filesystem::path& folder);

/// What stands at a path, links followed. \return kNotFound (nothing, or a link to nothing), kIo (it cannot be looked
/// at, links in a circle).
[[nodiscard]] Expected<std::filesystem::file_type> type_at(const std::filesystem::path& path);

/// Whether a folder, or a file, stands there, and why not. \return what type_at fails with; kIo (something else).
[[nodiscard]] Expected<void> expect_folder(const std::filesystem::path& path);
[[nodiscard]] Expected<void> expect_file(const std::filesystem::path& path);

/// The first few of several names, fit to print: "a, b, c, d, e, ...".
[[nodiscard]] std::string some_of(const std::vector<std::string>& names);

/// A path as it is shown in messages: bytes that would steer a terminal replaced.
[[nodiscard]] std::string shown(const std::filesystem::path& path);

}  // namespace kilter
