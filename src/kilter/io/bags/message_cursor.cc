// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/message_cursor.h"

#include <fmt/format.h>

namespace kilter {

Expected<MessageCursor> MessageCursor::open(std::string_view bytes, MessageEncoding encoding,
                                            const std::string& where) {
  if (encoding != MessageEncoding::kCdr) return MessageCursor(bytes, encoding, std::endian::little);
  // Two bytes say how what follows is written, two are options.
  if (bytes.size() < 4) return fail(ErrorCode::kTruncated, "the message ends inside its encapsulation header", where);
  const auto kind = load<std::uint16_t>(bytes.data(), std::endian::big);
  if (kind > 1) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("expected plain CDR (representation 0 or 1), found representation {}", kind), where);
  }
  return MessageCursor(bytes.substr(4), encoding, kind == 0 ? std::endian::big : std::endian::little);
}

void MessageCursor::align(std::size_t size) {
  if (encoding_ != MessageEncoding::kCdr) return;
  const std::size_t padding = (size - position_ % size) % size;
  if (padding > 0) static_cast<void>(take_bytes(padding));
}

std::string_view MessageCursor::take_bytes(std::size_t count) {
  if (!ok_ || count > remaining()) {
    ok_ = false;
    return {};
  }
  const std::string_view bytes = bytes_.substr(position_, count);
  position_ += count;
  return bytes;
}

std::string_view MessageCursor::take_text() {
  const auto length = take<std::uint32_t>();
  std::string_view text = take_bytes(length);
  if (encoding_ == MessageEncoding::kCdr && text.ends_with('\0')) text.remove_suffix(1);
  return text;
}

std::uint32_t MessageCursor::take_count(std::size_t min_bytes) {
  const auto count = take<std::uint32_t>();
  if (count > remaining() / min_bytes) ok_ = false;
  return ok_ ? count : 0;
}

}  // namespace kilter
