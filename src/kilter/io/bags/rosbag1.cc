// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/rosbag1.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "kilter/io/bags/chunk_store.h"
#include "kilter/io/bags/rosbag1_record.h"

namespace kilter {
namespace {

constexpr std::string_view kMagic = "#ROSBAG V2.0\n";

// Chunks of nothing that kilter reads are passed over, and where unpacking takes too long, any.
enum class WhatToCount { kOthersOnly, kAll };

class Rosbag1 final : public BagReader {
 public:
  explicit Rosbag1(RandomAccessFile file) : store_(std::move(file)), file_(store_.file(), 0, store_.file().size()) {}

  Expected<void> walk(const MessageVisitor& visit, UnpackingBudget& budget) override;
  Expected<MessageBytes> read(const MessagePlace& place) const override { return store_.read(place); }
  std::string where(const MessagePlace& place) const override { return store_.where(place); }

 private:
  Expected<void> read_bag_header();
  void read_connections(std::uint64_t position, std::uint32_t count);
  Expected<void> add_connection(ByteWindow& window, const Rosbag1Record& record);
  Expected<std::uint64_t> walk_chunk(const Rosbag1Record& record, const MessageVisitor& visit, UnpackingBudget& budget);
  Expected<std::uint64_t> walk_records(ByteWindow& window, std::uint32_t chunk, const MessageVisitor& visit);
  Expected<void> pass_message(ByteWindow& window, const Rosbag1Record& record, std::uint32_t chunk,
                              const MessageVisitor& visit);
  bool count_by_index(std::uint64_t chunk_end, WhatToCount what);
  Expected<void> end_early(std::uint64_t position);

  ChunkStore store_;
  ByteWindow file_;
  std::map<std::uint32_t, std::size_t> topic_of_;  // by connection
  std::uint64_t first_record_ = 0;
  std::uint64_t index_ = 0;  // where it begins; 0 while a bag is being written
};

Expected<void> Rosbag1::read_bag_header() {
  const auto record = read_rosbag1_record(file_, kMagic.size());
  if (!record) return pass_up(record.error());
  if (!record->is(Rosbag1Op::kBagHeader)) {
    return fail(ErrorCode::kParse, "expected the bag's header behind the version line", file_.where(kMagic.size()));
  }
  if (record->fields.encryptor && !record->fields.encryptor->empty()) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("the bag is encrypted ({})", printable(*record->fields.encryptor, 80)),
                file_.where(kMagic.size()), "`rosbag encrypt` of ROS 1 can undo it");
  }
  first_record_ = record->end();
  index_ = record->fields.index_position.value_or(0);
  if (index_ == 0) {
    notes_.push_back("the recording was never closed, so it has no index; it was read from the front");
  } else {
    read_connections(index_, record->fields.connection_count.value_or(0));
  }
  return {};
}

// What does not look like connections is no reason to fail: they stand in the chunks too.
void Rosbag1::read_connections(std::uint64_t position, std::uint32_t count) {
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto record = read_rosbag1_record(file_, position);
    if (!record || !record->is(Rosbag1Op::kConnection) || !add_connection(file_, *record)) {
      notes_.push_back("the index at the end is damaged or missing; the bag was read from the front");
      return;
    }
    position = record->end();
  }
}

Expected<void> Rosbag1::add_connection(ByteWindow& window, const Rosbag1Record& record) {
  const std::string where = window.where(record.data_begin);
  if (!record.fields.connection || !record.fields.topic) {
    return fail(ErrorCode::kParse, "a connection without number or topic", where);
  }
  if (topic_of_.contains(*record.fields.connection)) return {};
  const auto bytes = window.look(record.data_begin, record.data_size);
  if (!bytes) return pass_up(bytes.error());
  const auto fields = parse_rosbag1_fields(*bytes, where);
  if (!fields) return pass_up(fields.error());
  BagTopic topic{*record.fields.topic, fields->type.value_or(""), MessageEncoding::kRos1, RosType::kOther, 0};
  const auto index = find_or_add(std::move(topic), where);
  if (!index) return pass_up(index.error());
  topic_of_[*record.fields.connection] = *index;
  return {};
}

Expected<void> Rosbag1::pass_message(ByteWindow& window, const Rosbag1Record& record, std::uint32_t chunk,
                                     const MessageVisitor& visit) {
  const auto found = topic_of_.find(record.fields.connection.value_or(UINT32_MAX));
  if (found == topic_of_.end() || !record.fields.time_ns) {
    return fail(ErrorCode::kParse, "a message without a time or of a connection that no record introduced",
                window.where(record.data_begin));
  }
  BagTopic& topic = topics_[found->second];
  ++topic.messages;
  if (topic.ros_type == RosType::kOther) return {};
  const auto bytes = window.look(record.data_begin, std::min(record.data_size, bytes_wanted(topic.ros_type)));
  if (!bytes) return pass_up(bytes.error());
  visit({found->second, *record.fields.time_ns, {chunk, record.data_begin, record.data_size}, *bytes});
  return {};
}

// All records of a window, in a chunk or not. \return where the first one begins that is not whole, or the end.
Expected<std::uint64_t> Rosbag1::walk_records(ByteWindow& window, std::uint32_t chunk, const MessageVisitor& visit) {
  std::uint64_t position = window.begin();
  while (position < window.end()) {
    const auto record = read_rosbag1_record(window, position);
    if (!record && record.error().code == ErrorCode::kTruncated) return position;
    if (!record) return pass_up(record.error());
    if (!window.holds(record->data_begin, record->data_size)) return position;
    Expected<void> done;
    if (record->is(Rosbag1Op::kMessage)) done = pass_message(window, *record, chunk, visit);
    if (record->is(Rosbag1Op::kConnection)) done = add_connection(window, *record);
    if (!done) return pass_up(done.error());
    position = record->end();
  }
  return position;
}

// Whether the records behind a chunk say what it holds, and that this may be passed over; its messages are counted
// then. They are believed only if another record follows, so that none of them was cut off.
bool Rosbag1::count_by_index(std::uint64_t chunk_end, WhatToCount what) {
  std::vector<std::pair<std::size_t, std::uint32_t>> counts;
  auto record = read_rosbag1_record(file_, chunk_end);
  for (; record && record->is(Rosbag1Op::kIndex); record = read_rosbag1_record(file_, record->end())) {
    const auto found = topic_of_.find(record->fields.connection.value_or(UINT32_MAX));
    if (found == topic_of_.end() || !record->fields.count) return false;
    if (what == WhatToCount::kOthersOnly && topics_[found->second].ros_type != RosType::kOther) return false;
    counts.emplace_back(found->second, *record->fields.count);
  }
  if (!record || counts.empty()) return false;
  for (const auto& [topic, count] : counts) topics_[topic].messages += count;
  return true;
}

std::optional<Packing> packing_of(std::string_view name) {
  if (name == "none") return Packing::kNone;
  if (name == "bz2") return Packing::kBz2;
  if (name == "lz4") return Packing::kLz4;
  return std::nullopt;
}

// \return where the next record begins, or the chunk's own begin where it is not whole.
Expected<std::uint64_t> Rosbag1::walk_chunk(const Rosbag1Record& record, const MessageVisitor& visit,
                                            UnpackingBudget& budget) {
  const auto packing = packing_of(record.fields.compression.value_or(""));
  if (!packing || !record.fields.size) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("expected a chunk packed as none, bz2 or lz4 and its size, found \"{}\"",
                            printable(record.fields.compression.value_or(""), 40)),
                file_.where(record.data_begin));
  }
  const bool is_whole = file_.holds(record.data_begin, record.data_size);
  if (is_whole && count_by_index(record.end(), WhatToCount::kOthersOnly)) return record.end();
  if (*packing == Packing::kNone) {
    ByteWindow window(store_.file(), record.data_begin, std::min(record.end(), file_.end()));
    auto end = walk_records(window, MessagePlace::kNoChunk, visit);
    if (!end || *end == record.end() || !is_whole) return end;
    return fail(ErrorCode::kParse, "a record is longer than the chunk that holds it", file_.where(*end));
  }
  if (!is_whole) return record.data_begin;
  if (!budget.take(*packing, *record.fields.size)) {
    if (count_by_index(record.end(), WhatToCount::kAll)) return record.end();
    return refuse_to_pass_over(file_.where(record.data_begin));
  }
  const Expected<std::uint32_t> number =
      store_.add({*packing, record.data_begin, record.data_size, *record.fields.size, 0});
  if (!number) return pass_up(number.error());
  const auto bytes = store_.chunk(*number);
  if (!bytes) return pass_up(bytes.error());
  ByteWindow window((*bytes)->view(), store_.where_of_chunk(*number));
  auto end = walk_records(window, *number, visit);
  if (!end) return end;
  if (*end == window.end()) return record.end();
  return fail(ErrorCode::kParse, "a record is longer than the chunk that holds it", window.where(*end));
}

// A record reaches beyond the file's end. Where the index behind it still lies in the file, that is damage.
Expected<void> Rosbag1::end_early(std::uint64_t position) {
  if (position < index_ && index_ < file_.end()) {
    return fail(ErrorCode::kParse, "a record reaches beyond the end of the file", file_.where(position),
                "the bag is damaged here; `rosbag reindex` or `rosbag fix` may save the rest");
  }
  std::size_t messages = 0;
  for (const BagTopic& topic : topics_) messages += topic.messages;
  notes_.push_back(
      fmt::format("{}: the file ends in the middle of a record, so the recording was cut short; the {} whole "
                  "messages before were read",
                  file_.where(file_.end()), messages));
  return {};
}

Expected<void> Rosbag1::walk(const MessageVisitor& visit, UnpackingBudget& budget) {
  if (auto ok = read_bag_header(); !ok) return ok;
  std::uint64_t position = first_record_;
  while (position < file_.end()) {
    const auto record = read_rosbag1_record(file_, position);
    if (!record && record.error().code != ErrorCode::kTruncated) return pass_up(record.error());
    if (!record) return end_early(position);
    std::uint64_t next = record->end();
    if (record->is(Rosbag1Op::kChunk)) {
      const auto end = walk_chunk(*record, visit, budget);
      if (!end) return pass_up(end.error());
      next = *end;
    } else if (record->is(Rosbag1Op::kConnection) && file_.holds(record->data_begin, record->data_size)) {
      if (auto ok = add_connection(file_, *record); !ok) return ok;
    }
    if (next != record->end() || next > file_.end()) return end_early(position);
    position = next;
  }
  return {};
}

}  // namespace

Expected<std::unique_ptr<BagReader>> open_rosbag1(RandomAccessFile file) {
  std::string start(std::min<std::uint64_t>(file.size(), kMagic.size()), '\0');
  if (auto ok = file.read_at(0, start.data(), start.size()); !ok) return pass_up(ok.error());
  if (start == kMagic) return std::make_unique<Rosbag1>(std::move(file));
  if (start.starts_with(kRosbag1Magic)) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("expected a bag of version 2.0, found \"{}\"", printable(start.substr(1), 40)),
                at_byte(file.where(), 0), "`rosbag migrate` writes it anew");
  }
  return fail(ErrorCode::kParse, "expected a ROS 1 bag, which begins with \"#ROSBAG V2.0\"", at_byte(file.where(), 0));
}

}  // namespace kilter
