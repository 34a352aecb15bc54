// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/random_access_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace kilter {
namespace {

// A few records' heads, so that walking past large messages reads little of them.
constexpr std::uint64_t kWindowBytes = 16 * 1024;

}  // namespace

Expected<RandomAccessFile> RandomAccessFile::open(const std::filesystem::path& path) {
  Expected<OpenFile> file = open_regular_file(path);
  if (!file) return pass_up(file.error());
  return RandomAccessFile(std::move(file->descriptor), {}, file->size, shown(path));
}

RandomAccessFile RandomAccessFile::over(std::string_view bytes, std::string where) {
  return {std::nullopt, bytes, bytes.size(), std::move(where)};
}

Expected<void> RandomAccessFile::read_at(std::uint64_t offset, char* into, std::size_t size) const {
  if (offset > size_ || size > size_ - offset) {
    return fail(ErrorCode::kTruncated,
                fmt::format("{} bytes are promised, {} are left", size, offset > size_ ? 0 : size_ - offset),
                at_byte(where_, offset));
  }
  if (!file_) {
    if (size > 0) std::memcpy(into, bytes_.data() + offset, size);
    return {};
  }
  std::size_t done = 0;
  while (done < size) {
    const ssize_t step =
        ::pread(file_->number(), into + done, std::min(size - done, kMaxStep), static_cast<off_t>(offset + done));
    if (step < 0 && errno == EINTR) continue;
    if (step < 0) return fail(ErrorCode::kIo, fmt::format("cannot be read: {}", reason(errno)), where_);
    if (step == 0) {
      return fail(ErrorCode::kTruncated, "the file shrank while being read", at_byte(where_, offset + done));
    }
    done += static_cast<std::size_t>(step);
  }
  return {};
}

Expected<ByteBuffer> RandomAccessFile::read(std::uint64_t offset, std::uint64_t size) const {
  if (offset > size_ || size > size_ - offset) return pass_up(read_at(offset, nullptr, size).error());
  Expected<ByteBuffer> buffer = ByteBuffer::allocate(static_cast<std::size_t>(size));
  if (!buffer) {
    buffer.error().where = at_byte(where_, offset);
    return buffer;
  }
  if (auto ok = read_at(offset, buffer->data(), buffer->size()); !ok) return pass_up(ok.error());
  return buffer;
}

std::string at_byte(const std::string& where, std::uint64_t offset) {
  return fmt::format("{}: byte {}", where, offset);
}

Expected<std::string_view> ByteWindow::look(std::uint64_t position, std::uint64_t size) {
  if (!holds(position, size)) {
    return fail(ErrorCode::kTruncated,
                fmt::format("{} bytes are promised, {} are left", size, position > end_ ? 0 : end_ - position),
                where(position));
  }
  const bool is_held =
      position >= held_at_ && position - held_at_ <= held_.size() && size <= held_.size() - (position - held_at_);
  if (!is_held) {
    // Not before the buffer is there does the window forget what it held.
    const std::uint64_t wanted = std::min(std::max(size, kWindowBytes), end_ - position);
    if (wanted > buffer_.size() || buffer_.size() > 16 * kWindowBytes) {
      Expected<ByteBuffer> buffer = ByteBuffer::allocate(static_cast<std::size_t>(std::max(wanted, kWindowBytes)));
      if (!buffer) return pass_up(buffer.error());
      buffer_ = *std::move(buffer);
      held_ = {};
    }
    held_ = {};
    if (auto ok = file_->read_at(position, buffer_.data(), static_cast<std::size_t>(wanted)); !ok) {
      return pass_up(ok.error());
    }
    held_ = buffer_.view().substr(0, static_cast<std::size_t>(wanted));
    held_at_ = position;
  }
  return held_.substr(static_cast<std::size_t>(position - held_at_), static_cast<std::size_t>(size));
}

}  // namespace kilter
