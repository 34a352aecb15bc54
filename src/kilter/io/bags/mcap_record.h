// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "kilter/base/expected.h"
#include "kilter/io/random_access_file.h"

namespace kilter {

/// What a record of an MCAP file is.
enum class McapOp : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kDataEnd = 0x0F,
};

/// One record: what it is, and where its content lies.
struct McapRecord {
  std::uint8_t op = 0;
  std::uint64_t begin = 0;
  std::uint64_t size = 0;

  /// Where the next record begins.
  [[nodiscard]] std::uint64_t end() const { return begin + size; }
  [[nodiscard]] bool is(McapOp other) const { return op == static_cast<std::uint8_t>(other); }
};

/// Bytes of a message record in front of the message itself.
inline constexpr std::uint64_t kMcapMessageHead = 22;

/// The record at a position. \return kTruncated (the window ends inside it, or it claims more than is left), kIo.
[[nodiscard]] Expected<McapRecord> read_mcap_record(ByteWindow& window, std::uint64_t position);

/// A type that messages have.
struct McapSchema {
  std::uint16_t id = 0;
  std::string name;
};

/// A topic, and how its messages are written.
struct McapChannel {
  std::uint16_t id = 0;
  std::uint16_t schema = 0;  ///< 0: none
  std::string topic;
  std::string encoding;
};

/// A message's head.
struct McapMessage {
  std::uint16_t channel = 0;
  std::int64_t log_ns = 0;  ///< beyond the year 2262: the last moment before
};

/// What stands in front of a chunk's records.
struct McapChunk {
  std::uint64_t unpacked_bytes = 0;
  std::uint32_t crc32 = 0;  ///< 0: none
  std::string compression;
  std::uint64_t begin = 0;  ///< of the packed records, in the file
  std::uint64_t size = 0;
};

/// Each of these takes one record's content apart. \pre the record is whole in the window.
/// \return  kParse with the byte: a length beyond the record's end; kIo, kOutOfMemory.
[[nodiscard]] Expected<McapSchema> read_mcap_schema(ByteWindow& window, const McapRecord& record);
[[nodiscard]] Expected<McapChannel> read_mcap_channel(ByteWindow& window, const McapRecord& record);
[[nodiscard]] Expected<McapMessage> read_mcap_message(ByteWindow& window, const McapRecord& record);
/// A chunk may be cut by the file's end: only its head has to be there, else kTruncated.
[[nodiscard]] Expected<McapChunk> read_mcap_chunk(ByteWindow& window, std::uint64_t begin, std::uint64_t size);

}  // namespace kilter
