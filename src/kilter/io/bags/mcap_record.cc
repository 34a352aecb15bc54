// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/mcap_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "kilter/io/byte_cursor.h"
#include "kilter/io/scalar.h"

namespace kilter {
namespace {

template <typename T>
std::optional<T> take_number(ByteCursor& bytes) {
  const auto taken = bytes.take(sizeof(T));
  if (!taken) return std::nullopt;
  return load<T>(taken->data(), std::endian::little);
}

std::optional<std::string> take_text(ByteCursor& bytes) {
  const auto length = take_number<std::uint32_t>(bytes);
  const auto text = length ? bytes.take(*length) : std::nullopt;
  if (!text) return std::nullopt;
  return std::string(*text);
}

tl::unexpected<Error> refuse_record(std::string_view what, ByteWindow& window, std::uint64_t begin) {
  return fail(ErrorCode::kParse, fmt::format("a {} record is shorter than the lengths in it", what),
              window.where(begin), "the file is damaged here; `mcap recover IN -o OUT` may save the rest");
}

}  // namespace

Expected<McapRecord> read_mcap_record(ByteWindow& window, std::uint64_t position) {
  const auto head = window.look(position, 9);
  if (!head) return pass_up(head.error());
  McapRecord record;
  record.op = static_cast<std::uint8_t>(head->front());
  record.begin = position + 9;
  record.size = load<std::uint64_t>(head->data() + 1, std::endian::little);
  if (window.holds(record.begin, record.size)) return record;
  return fail(ErrorCode::kTruncated,
              fmt::format("a record claims {} bytes, {} are left", record.size, window.end() - record.begin),
              window.where(position));
}

Expected<McapSchema> read_mcap_schema(ByteWindow& window, const McapRecord& record) {
  const auto bytes = window.look(record.begin, record.size);
  if (!bytes) return pass_up(bytes.error());
  ByteCursor cursor(*bytes);
  const auto id = take_number<std::uint16_t>(cursor);
  auto name = id ? take_text(cursor) : std::nullopt;
  if (!name) return refuse_record("schema", window, record.begin);
  return McapSchema{*id, *std::move(name)};
}

Expected<McapChannel> read_mcap_channel(ByteWindow& window, const McapRecord& record) {
  const auto bytes = window.look(record.begin, record.size);
  if (!bytes) return pass_up(bytes.error());
  ByteCursor cursor(*bytes);
  const auto id = take_number<std::uint16_t>(cursor);
  const auto schema = take_number<std::uint16_t>(cursor);
  auto topic = id && schema ? take_text(cursor) : std::nullopt;
  auto encoding = topic ? take_text(cursor) : std::nullopt;
  if (!encoding) return refuse_record("channel", window, record.begin);
  return McapChannel{*id, *schema, *std::move(topic), *std::move(encoding)};
}

Expected<McapMessage> read_mcap_message(ByteWindow& window, const McapRecord& record) {
  if (record.size < kMcapMessageHead) return refuse_record("message", window, record.begin);
  const auto bytes = window.look(record.begin, kMcapMessageHead);
  if (!bytes) return pass_up(bytes.error());
  constexpr std::uint64_t kLast = std::numeric_limits<std::int64_t>::max();
  const auto log_ns = load<std::uint64_t>(bytes->data() + 6, std::endian::little);
  return McapMessage{load<std::uint16_t>(bytes->data(), std::endian::little),
                     static_cast<std::int64_t>(std::min(log_ns, kLast))};
}

Expected<McapChunk> read_mcap_chunk(ByteWindow& window, std::uint64_t begin, std::uint64_t size) {
  // Two stamps, size, checksum, the name's length; the name; the records' length.
  constexpr std::uint64_t kBeforeName = 32;
  if (size < kBeforeName) return refuse_record("chunk", window, begin);
  auto bytes = window.look(begin, kBeforeName);
  if (!bytes) return pass_up(bytes.error());
  McapChunk chunk;
  chunk.unpacked_bytes = load<std::uint64_t>(bytes->data() + 16, std::endian::little);
  chunk.crc32 = load<std::uint32_t>(bytes->data() + 24, std::endian::little);
  const std::uint64_t name = load<std::uint32_t>(bytes->data() + 28, std::endian::little);
  if (name + 8 > size - kBeforeName) return refuse_record("chunk", window, begin);
  bytes = window.look(begin + kBeforeName, name + 8);
  if (!bytes) return pass_up(bytes.error());
  chunk.compression = std::string(bytes->substr(0, static_cast<std::size_t>(name)));
  chunk.size = load<std::uint64_t>(bytes->data() + name, std::endian::little);
  chunk.begin = begin + kBeforeName + name + 8;
  if (chunk.size > size - kBeforeName - name - 8) return refuse_record("chunk", window, begin);
  return chunk;
}

}  // namespace kilter
