// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "kilter/base/expected.h"
#include "kilter/io/random_access_file.h"

namespace kilter {

/// What a record of a ROS 1 bag is.
enum class Rosbag1Op : std::uint8_t {
  kMessage = 2,
  kBagHeader = 3,
  kIndex = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7,
};

/// The fields of a record's header that kilter uses; each absent where the record has none of that name.
struct Rosbag1Fields {
  std::optional<std::uint8_t> op;
  std::optional<std::uint32_t> connection;
  std::optional<std::uint32_t> count;
  std::optional<std::uint32_t> size;
  std::optional<std::uint64_t> index_position;
  std::optional<std::uint32_t> connection_count;
  std::optional<std::int64_t> time_ns;
  std::optional<std::string> topic;
  std::optional<std::string> type;
  std::optional<std::string> compression;
  std::optional<std::string> encryptor;
};

/// Takes apart `<length>name=value...`. Names that are not known are passed over.
/// \return  kParse with the byte: a length beyond the end, a field without '=', a number of another length.
[[nodiscard]] Expected<Rosbag1Fields> parse_rosbag1_fields(std::string_view bytes, const std::string& where);

/// One record: its header, and where its data lie.
struct Rosbag1Record {
  Rosbag1Fields fields;
  std::uint64_t data_begin = 0;
  std::uint64_t data_size = 0;

  /// Where the next record begins; may lie behind the window where the file was cut.
  [[nodiscard]] std::uint64_t end() const { return data_begin + data_size; }
  [[nodiscard]] bool is(Rosbag1Op op) const { return fields.op == static_cast<std::uint8_t>(op); }
};

/// Reads the record at a position; its data may or may not be there.
/// \return  kTruncated (the window ends inside the header or the lengths), kParse, kIo.
[[nodiscard]] Expected<Rosbag1Record> read_rosbag1_record(ByteWindow& window, std::uint64_t position);

}  // namespace kilter
