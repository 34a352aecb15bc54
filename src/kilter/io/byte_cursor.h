// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstring>
#include <optional>
#include <string_view>

namespace kilter {

/// Walks through bytes from outside. Nothing can be taken that is not there, and no sum can wrap; it never copies.
class ByteCursor {
 public:
  explicit ByteCursor(std::string_view bytes) : rest_(bytes), size_(bytes.size()) {}

  /// Everything not yet taken.
  [[nodiscard]] std::string_view rest() const { return rest_; }
  [[nodiscard]] std::size_t remaining() const { return rest_.size(); }
  /// Bytes taken so far.
  [[nodiscard]] std::size_t position() const { return size_ - rest_.size(); }
  /// Number of the line taken last, from 1; 0 before the first.
  [[nodiscard]] std::size_t line() const { return line_; }

  /// The next `count` bytes, or nothing (and nothing is taken) when fewer are left.
  std::optional<std::string_view> take(std::size_t count) {
    if (count > rest_.size()) return std::nullopt;
    const std::string_view taken = rest_.substr(0, count);
    rest_.remove_prefix(count);
    return taken;
  }

  /// The next line without its "\n" or "\r\n"; the last one needs no line end. Nothing at the end of the bytes.
  std::optional<std::string_view> take_line() {
    if (rest_.empty()) return std::nullopt;
    const void* newline = std::memchr(rest_.data(), '\n', rest_.size());
    const std::size_t length =
        newline == nullptr ? rest_.size() : static_cast<std::size_t>(static_cast<const char*>(newline) - rest_.data());
    std::string_view line = rest_.substr(0, length);
    rest_.remove_prefix(newline == nullptr ? length : length + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    ++line_;
    return line;
  }

 private:
  std::string_view rest_;
  std::size_t size_;
  std::size_t line_ = 0;
};

/// Whether all bytes are zero. Older writers of binary PCD files pad them by most of a page.
[[nodiscard]] constexpr bool is_padding(std::string_view bytes) {
  return bytes.find_first_not_of('\0') == std::string_view::npos;
}

/// Text files from other systems may begin with a byte order mark (UTF-8).
[[nodiscard]] constexpr std::string_view without_byte_order_mark(std::string_view bytes) {
  return bytes.starts_with("\xEF\xBB\xBF") ? bytes.substr(3) : bytes;
}

}  // namespace kilter
