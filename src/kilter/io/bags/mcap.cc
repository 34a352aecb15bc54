// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/mcap.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "kilter/io/bags/chunk_store.h"
#include "kilter/io/bags/mcap_record.h"
#include "kilter/io/scalar.h"

namespace kilter {
namespace {

MessageEncoding encoding_of(std::string_view name) {
  if (name == "cdr") return MessageEncoding::kCdr;
  return name == "ros1" ? MessageEncoding::kRos1 : MessageEncoding::kOther;
}

std::optional<Packing> packing_of(std::string_view name) {
  if (name.empty()) return Packing::kNone;
  if (name == "lz4") return Packing::kLz4;
  if (name == "zstd") return Packing::kZstd;
  return std::nullopt;
}

// Chunks of nothing that kilter reads are passed over, and where unpacking takes too long, any.
enum class WhatToCount { kOthersOnly, kAll };

class Mcap final : public BagReader {
 public:
  explicit Mcap(RandomAccessFile file) : store_(std::move(file)), file_(store_.file(), 0, store_.file().size()) {}

  Expected<void> walk(const MessageVisitor& visit, UnpackingBudget& budget) override;
  Expected<MessageBytes> read(const MessagePlace& place) const override { return store_.read(place); }
  std::string where(const MessagePlace& place) const override { return store_.where(place); }

 private:
  void read_summary();
  Expected<void> walk_record(ByteWindow& window, const McapRecord& record, std::uint32_t chunk,
                             const MessageVisitor& visit);
  Expected<void> add_channel(ByteWindow& window, const McapRecord& record);
  Expected<void> pass_message(ByteWindow& window, const McapRecord& record, std::uint32_t chunk,
                              const MessageVisitor& visit);
  Expected<void> walk_chunk(const McapRecord& record, const MessageVisitor& visit, UnpackingBudget& budget);
  Expected<void> walk_inside(ByteWindow& window, std::uint32_t chunk, const MessageVisitor& visit);
  Expected<void> walk_cut_record(std::uint64_t position, const MessageVisitor& visit);
  bool count_by_index(std::uint64_t chunk_end, WhatToCount what);
  bool is_closed();

  ChunkStore store_;
  ByteWindow file_;
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, std::size_t> topic_of_;  // by channel
};

// What does not look like a summary is no reason to fail: schemas and channels stand in front of messages too.
void Mcap::read_summary() {
  constexpr std::uint64_t kFooterContent = 20;
  constexpr std::uint64_t kFooter = 9 + kFooterContent;
  const std::uint64_t tail = kFooter + kMcapMagic.size();
  if (file_.end() < kMcapMagic.size() + tail) return;
  const std::uint64_t footer = file_.end() - tail;
  const auto record = read_mcap_record(file_, footer);
  if (!record || !record->is(McapOp::kFooter) || record->size != kFooterContent) return;
  const auto start = file_.look(record->begin, 8);
  if (!start) return;
  std::uint64_t position = load<std::uint64_t>(start->data(), std::endian::little);
  if (position == 0) return;
  while (position < footer) {
    const auto entry = read_mcap_record(file_, position);
    if (!entry) return;
    if (entry->is(McapOp::kSchema) || entry->is(McapOp::kChannel)) {
      if (!walk_record(file_, *entry, MessagePlace::kNoChunk, {})) return;
    }
    position = entry->end();
  }
}

Expected<void> Mcap::add_channel(ByteWindow& window, const McapRecord& record) {
  const auto channel = read_mcap_channel(window, record);
  if (!channel) return pass_up(channel.error());
  if (topic_of_.contains(channel->id)) return {};
  const auto schema = schemas_.find(channel->schema);
  BagTopic topic{channel->topic, schema == schemas_.end() ? "no schema" : schema->second,
                 encoding_of(channel->encoding), RosType::kOther, 0};
  if (topic.encoding == MessageEncoding::kOther) topic.type += " as " + channel->encoding;
  const auto index = find_or_add(std::move(topic), window.where(record.begin));
  if (!index) return pass_up(index.error());
  topic_of_[channel->id] = *index;
  return {};
}

Expected<void> Mcap::pass_message(ByteWindow& window, const McapRecord& record, std::uint32_t chunk,
                                  const MessageVisitor& visit) {
  const auto message = read_mcap_message(window, record);
  if (!message) return pass_up(message.error());
  const auto found = topic_of_.find(message->channel);
  if (found == topic_of_.end()) {
    return fail(ErrorCode::kParse, fmt::format("a message of channel {}, which no record introduced", message->channel),
                window.where(record.begin));
  }
  BagTopic& topic = topics_[found->second];
  ++topic.messages;
  if (topic.ros_type == RosType::kOther) return {};
  const MessagePlace place{chunk, record.begin + kMcapMessageHead, record.size - kMcapMessageHead};
  const auto bytes = window.look(place.offset, std::min(place.size, bytes_wanted(topic.ros_type)));
  if (!bytes) return pass_up(bytes.error());
  visit({found->second, message->log_ns, place, *bytes});
  return {};
}

Expected<void> Mcap::walk_record(ByteWindow& window, const McapRecord& record, std::uint32_t chunk,
                                 const MessageVisitor& visit) {
  if (record.is(McapOp::kMessage)) return pass_message(window, record, chunk, visit);
  if (record.is(McapOp::kChannel)) return add_channel(window, record);
  if (!record.is(McapOp::kSchema)) return {};
  auto schema = read_mcap_schema(window, record);
  if (!schema) return pass_up(schema.error());
  schemas_.try_emplace(schema->id, std::move(schema->name));
  return {};
}

Expected<void> Mcap::walk_inside(ByteWindow& window, std::uint32_t chunk, const MessageVisitor& visit) {
  for (std::uint64_t position = window.begin(); position < window.end();) {
    const auto record = read_mcap_record(window, position);
    if (!record) return pass_up(record.error());
    if (auto ok = walk_record(window, *record, chunk, visit); !ok) return ok;
    position = record->end();
  }
  return {};
}

// Whether the records behind a chunk say what it holds, and that this may be passed over; its messages are counted
// then. They are believed only if another record follows, so that none of them was cut off.
bool Mcap::count_by_index(std::uint64_t chunk_end, WhatToCount what) {
  constexpr std::uint64_t kEntry = 16;
  std::vector<std::pair<std::size_t, std::uint64_t>> counts;
  auto record = read_mcap_record(file_, chunk_end);
  for (; record && record->is(McapOp::kMessageIndex); record = read_mcap_record(file_, record->end())) {
    const auto head = record->size < 6 ? Expected<std::string_view>("") : file_.look(record->begin, 6);
    if (!head || head->empty()) return false;
    const auto found = topic_of_.find(load<std::uint16_t>(head->data(), std::endian::little));
    if (found == topic_of_.end()) return false;
    if (what == WhatToCount::kOthersOnly && topics_[found->second].ros_type != RosType::kOther) return false;
    counts.emplace_back(found->second, load<std::uint32_t>(head->data() + 2, std::endian::little) / kEntry);
  }
  if (!record || counts.empty()) return false;
  for (const auto& [topic, count] : counts) topics_[topic].messages += count;
  return true;
}

Expected<void> Mcap::walk_chunk(const McapRecord& record, const MessageVisitor& visit, UnpackingBudget& budget) {
  const auto chunk = read_mcap_chunk(file_, record.begin, record.size);
  if (!chunk) return pass_up(chunk.error());
  const auto packing = packing_of(chunk->compression);
  if (!packing) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("expected a chunk packed as lz4, zstd or not at all, found \"{}\"",
                            printable(chunk->compression, 40)),
                file_.where(record.begin), "`mcap compress --compression zstd` writes it anew");
  }
  if (count_by_index(record.end(), WhatToCount::kOthersOnly)) return {};
  if (*packing == Packing::kNone) {
    ByteWindow window(store_.file(), chunk->begin, chunk->begin + chunk->size);
    return walk_inside(window, MessagePlace::kNoChunk, visit);
  }
  if (!budget.take(*packing, chunk->unpacked_bytes)) {
    if (count_by_index(record.end(), WhatToCount::kAll)) return {};
    return refuse_to_pass_over(file_.where(record.begin));
  }
  const Expected<std::uint32_t> number =
      store_.add({*packing, chunk->begin, chunk->size, chunk->unpacked_bytes, chunk->crc32});
  if (!number) return pass_up(number.error());
  const auto bytes = store_.chunk(*number);
  if (!bytes) return pass_up(bytes.error());
  ByteWindow window((*bytes)->view(), store_.where_of_chunk(*number));
  return walk_inside(window, *number, visit);
}

// The file ends inside this record. Whole messages of a chunk that is not packed can still be had.
Expected<void> Mcap::walk_cut_record(std::uint64_t position, const MessageVisitor& visit) {
  const auto head = file_.look(position, 9);
  if (head && head->front() == static_cast<char>(McapOp::kChunk)) {
    const auto chunk = read_mcap_chunk(file_, position + 9, load<std::uint64_t>(head->data() + 1, std::endian::little));
    if (chunk && chunk->compression.empty() && chunk->begin <= file_.end()) {
      ByteWindow window(store_.file(), chunk->begin, file_.end());
      auto done = walk_inside(window, MessagePlace::kNoChunk, visit);
      if (!done && done.error().code != ErrorCode::kTruncated) return done;
    }
  }
  return {};
}

// A file with its end is whole; a record in it that reaches beyond is damage, not a recording cut short.
bool Mcap::is_closed() {
  const auto end = file_.look(file_.end() - kMcapMagic.size(), kMcapMagic.size());
  return file_.end() > 2 * kMcapMagic.size() && end && *end == kMcapMagic;
}

Expected<void> Mcap::walk(const MessageVisitor& visit, UnpackingBudget& budget) {
  read_summary();
  std::uint64_t position = kMcapMagic.size();
  const std::uint64_t end = is_closed() ? file_.end() - kMcapMagic.size() : file_.end();
  while (position < end) {
    const auto record = read_mcap_record(file_, position);
    if (!record && (record.error().code != ErrorCode::kTruncated || is_closed())) return pass_up(record.error());
    if (!record) {
      if (auto ok = walk_cut_record(position, visit); !ok) return ok;
      break;
    }
    if (record->is(McapOp::kDataEnd) || record->is(McapOp::kFooter)) return {};
    auto done = record->is(McapOp::kChunk) ? walk_chunk(*record, visit, budget)
                                           : walk_record(file_, *record, MessagePlace::kNoChunk, visit);
    if (!done) return done;
    position = record->end();
  }
  std::size_t messages = 0;
  for (const BagTopic& topic : topics_) messages += topic.messages;
  notes_.push_back(
      fmt::format("{}: the file has no end, so the recording was cut short; the {} whole messages before "
                  "were read",
                  file_.where(file_.end()), messages));
  return {};
}

}  // namespace

Expected<std::unique_ptr<BagReader>> open_mcap(RandomAccessFile file) {
  std::string start(static_cast<std::size_t>(std::min<std::uint64_t>(file.size(), kMcapMagic.size())), '\0');
  if (auto ok = file.read_at(0, start.data(), start.size()); !ok) return pass_up(ok.error());
  if (start == kMcapMagic) return std::make_unique<Mcap>(std::move(file));
  if (start.starts_with(kMcapMagic.substr(0, 5))) {
    return fail(ErrorCode::kUnsupported, "expected MCAP of major version 0, found another", at_byte(file.where(), 5));
  }
  return fail(ErrorCode::kParse, "expected an MCAP file, which begins with 89 4D 43 41 50 30",
              at_byte(file.where(), 0));
}

}  // namespace kilter
