// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "testing/bag_bytes.h"

#include <bzlib.h>
#include <gtest/gtest.h>
#include <lz4frame.h>
#include <sqlite3.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <map>
#include <memory>

#include "testing/cloud_bytes.h"

namespace kilter_testing {
namespace {

std::string packed(const std::string& bytes, BagPacking packing) {
  std::string out(2 * bytes.size() + 4096, '\0');
  switch (packing) {
    case BagPacking::kNone:
      return bytes;
    case BagPacking::kZstd:
      return zstd_bytes(bytes);
    case BagPacking::kBz2: {
      auto size = static_cast<unsigned>(out.size());
      std::string in = bytes;
      EXPECT_EQ(BZ2_bzBuffToBuffCompress(out.data(), &size, in.data(), static_cast<unsigned>(in.size()), 9, 0, 0),
                BZ_OK);
      out.resize(size);
      return out;
    }
    case BagPacking::kLz4: {
      // ROS 1 reads no other frames than these.
      LZ4F_preferences_t preferences{};
      preferences.frameInfo.blockMode = LZ4F_blockIndependent;
      preferences.frameInfo.contentChecksumFlag = LZ4F_contentChecksumEnabled;
      out.resize(LZ4F_compressFrame(out.data(), out.size(), bytes.data(), bytes.size(), &preferences));
      return out;
    }
  }
  return out;
}

// ROS 1: fields, record, time.
std::string field(const std::string& name, const std::string& value) {
  std::string bytes;
  put(bytes, static_cast<std::uint32_t>(name.size() + 1 + value.size()));
  return bytes + name + "=" + value;
}

template <typename T>
std::string number(T value) {
  std::string bytes;
  put(bytes, value);
  return bytes;
}

std::string op(int code) { return field("op", std::string(1, static_cast<char>(code))); }

std::string with_length(const std::string& bytes) { return number(static_cast<std::uint32_t>(bytes.size())) + bytes; }

std::string record(const std::string& header, const std::string& data) {
  return with_length(header) + with_length(data);
}

std::string ros_time(std::int64_t ns) {
  return number(static_cast<std::uint32_t>(ns / 1'000'000'000)) +
         number(static_cast<std::uint32_t>(ns % 1'000'000'000));
}

std::uint32_t index_of(std::vector<std::string>& topics, const std::string& topic) {
  const auto found = std::find(topics.begin(), topics.end(), topic);
  const auto index = static_cast<std::uint32_t>(found - topics.begin());
  if (found == topics.end()) topics.push_back(topic);
  return index;
}

std::string connection_record(std::uint32_t number_of, const RecordedMessage& message) {
  return record(op(7) + field("conn", number(number_of)) + field("topic", message.topic),
                field("topic", message.topic) + field("type", message.type) + field("md5sum", std::string(32, 'a')) +
                    field("message_definition", "float64 x\n"));
}

std::string bag_header(std::uint64_t index, std::size_t connections, std::size_t chunks) {
  const std::string header = op(3) + field("index_pos", number(index)) +
                             field("conn_count", number(static_cast<std::uint32_t>(connections))) +
                             field("chunk_count", number(static_cast<std::uint32_t>(chunks)));
  return record(header, std::string(4096 - header.size(), ' '));
}

// MCAP: record, text.
std::string mcap_record(int code, const std::string& content) {
  return std::string(1, static_cast<char>(code)) + number(static_cast<std::uint64_t>(content.size())) + content;
}

std::string ros2_type(const std::string& type) {
  const std::size_t slash = type.find('/');
  return type.substr(0, slash) + "/msg" + type.substr(slash);
}

std::string schema_and_channel(std::uint16_t id, const RecordedMessage& message, const std::string& encoding) {
  const std::string schema = number(id) + with_length(encoding == "ros1" ? message.type : ros2_type(message.type)) +
                             with_length("ros2msg") + with_length("float64 x\n");
  const std::string channel =
      number(id) + number(id) + with_length(message.topic) + with_length(encoding) + with_length("");
  return mcap_record(3, schema) + mcap_record(4, channel);
}

std::uint32_t crc(const std::string& bytes) {
  return static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}

std::string mcap_chunk(const std::string& records, BagPacking packing) {
  const std::map<BagPacking, std::string> names = {
      {BagPacking::kNone, ""}, {BagPacking::kLz4, "lz4"}, {BagPacking::kZstd, "zstd"}, {BagPacking::kBz2, "bz2"}};
  const std::string body = packed(records, packing);
  return mcap_record(6, number(std::uint64_t{0}) + number(std::uint64_t{0}) +
                            number(static_cast<std::uint64_t>(records.size())) + number(crc(records)) +
                            with_length(names.at(packing)) + number(static_cast<std::uint64_t>(body.size())) + body);
}

}  // namespace

std::string zstd_bytes(const std::string& bytes) {
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  out.resize(ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 3));
  return out;
}

std::string rosbag1_bytes(const std::vector<RecordedMessage>& messages, const BagLayout& layout) {
  const std::map<BagPacking, std::string> names = {
      {BagPacking::kNone, "none"}, {BagPacking::kBz2, "bz2"}, {BagPacking::kLz4, "lz4"}, {BagPacking::kZstd, "zstd"}};
  std::vector<std::string> topics;
  std::string connections;
  std::string chunks;
  std::string infos;
  std::size_t count = 0;
  const std::size_t start = 13 + bag_header(0, 0, 0).size();
  for (std::size_t first = 0; first < messages.size(); first += layout.messages_per_chunk, ++count) {
    std::string body;
    std::map<std::uint32_t, std::string> entries;
    const std::size_t last = std::min(messages.size(), first + layout.messages_per_chunk);
    for (std::size_t i = first; i < last; ++i) {
      const std::size_t known = topics.size();
      const std::uint32_t id = index_of(topics, messages[i].topic);
      if (topics.size() > known) {
        body += connection_record(id, messages[i]);
        connections += connection_record(id, messages[i]);
      }
      entries[id] += ros_time(messages[i].log_ns) + number(static_cast<std::uint32_t>(body.size()));
      body +=
          record(op(2) + field("conn", number(id)) + field("time", ros_time(messages[i].log_ns)), messages[i].bytes);
    }
    const std::uint64_t place = start + chunks.size();
    chunks += record(op(5) + field("compression", names.at(layout.packing)) +
                         field("size", number(static_cast<std::uint32_t>(body.size()))),
                     packed(body, layout.packing));
    std::string per_connection;
    for (const auto& [id, data] : entries) {
      const auto times = static_cast<std::uint32_t>(data.size() / 12);
      chunks += record(
          op(4) + field("ver", number(std::uint32_t{1})) + field("conn", number(id)) + field("count", number(times)),
          data);
      per_connection += number(id) + number(times);
    }
    infos += record(op(6) + field("ver", number(std::uint32_t{1})) + field("chunk_pos", number(place)) +
                        field("start_time", ros_time(0)) + field("end_time", ros_time(0)) +
                        field("count", number(static_cast<std::uint32_t>(entries.size()))),
                    per_connection);
  }
  if (!layout.is_closed) return "#ROSBAG V2.0\n" + bag_header(0, 0, 0) + chunks;
  return "#ROSBAG V2.0\n" + bag_header(start + chunks.size(), topics.size(), count) + chunks + connections + infos;
}

std::string mcap_bytes(const std::vector<RecordedMessage>& messages, const BagLayout& layout) {
  const std::string magic("\x89MCAP0\r\n", 8);
  std::string file = magic + mcap_record(1, with_length("ros2") + with_length("a test"));
  std::vector<std::string> topics;
  std::string summary;
  std::string body;
  std::map<std::uint16_t, std::string> entries;
  const auto close_chunk = [&] {
    file += mcap_chunk(body, layout.packing);
    for (const auto& [id, list] : entries) file += mcap_record(7, number(id) + with_length(list));
    body.clear();
    entries.clear();
  };
  for (std::size_t i = 0; i < messages.size(); ++i) {
    std::string& into = layout.messages_per_chunk == 0 ? file : body;
    const std::size_t known = topics.size();
    const auto id = static_cast<std::uint16_t>(index_of(topics, messages[i].topic) + 1);
    if (topics.size() > known) {
      into += schema_and_channel(id, messages[i], layout.mcap_encoding);
      summary += schema_and_channel(id, messages[i], layout.mcap_encoding);
    }
    const auto log_ns = static_cast<std::uint64_t>(messages[i].log_ns);
    entries[id] += number(log_ns) + number(static_cast<std::uint64_t>(into.size()));
    into += mcap_record(5, number(id) + number(std::uint32_t{0}) + number(log_ns) + number(log_ns) + messages[i].bytes);
    if (layout.messages_per_chunk > 0 && (i + 1) % layout.messages_per_chunk == 0) close_chunk();
  }
  if (!body.empty()) close_chunk();
  if (!layout.is_closed) return file;
  file += mcap_record(15, number(std::uint32_t{0}));
  const std::uint64_t start = file.size();
  return file + summary + mcap_record(2, number(start) + number(std::uint64_t{0}) + number(std::uint32_t{0})) + magic;
}

void write_sqlite_bag(const std::filesystem::path& file, const std::vector<RecordedMessage>& messages) {
  sqlite3* raw = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &raw), SQLITE_OK);
  const std::unique_ptr<sqlite3, decltype(&sqlite3_close)> database(raw, &sqlite3_close);
  const auto run = [&](const char* text) { EXPECT_EQ(sqlite3_exec(raw, text, nullptr, nullptr, nullptr), SQLITE_OK); };
  run("BEGIN");
  run("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
      "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL)");
  run("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, "
      "data BLOB NOT NULL)");
  run("CREATE INDEX timestamp_idx ON messages (timestamp ASC)");
  std::vector<std::string> topics;
  for (const RecordedMessage& message : messages) {
    sqlite3_stmt* statement = nullptr;
    const std::size_t known = topics.size();
    const auto id = static_cast<int>(index_of(topics, message.topic) + 1);
    if (topics.size() > known) {
      sqlite3_prepare_v2(raw, "INSERT INTO topics VALUES(?1, ?2, ?3, 'cdr', '')", -1, &statement, nullptr);
      const std::string type = ros2_type(message.type);
      sqlite3_bind_int(statement, 1, id);
      sqlite3_bind_text(statement, 2, message.topic.c_str(), -1, SQLITE_TRANSIENT);
      sqlite3_bind_text(statement, 3, type.c_str(), -1, SQLITE_TRANSIENT);
      EXPECT_EQ(sqlite3_step(statement), SQLITE_DONE);
      sqlite3_finalize(statement);
    }
    sqlite3_prepare_v2(raw, "INSERT INTO messages(topic_id, timestamp, data) VALUES(?1, ?2, ?3)", -1, &statement,
                       nullptr);
    sqlite3_bind_int(statement, 1, id);
    sqlite3_bind_int64(statement, 2, message.log_ns);
    sqlite3_bind_blob(statement, 3, message.bytes.data(), static_cast<int>(message.bytes.size()), SQLITE_TRANSIENT);
    EXPECT_EQ(sqlite3_step(statement), SQLITE_DONE);
    sqlite3_finalize(statement);
  }
  run("COMMIT");
}

}  // namespace kilter_testing
