// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/io/bags/decompress.h"
#include "kilter/io/bags/ros_type.h"
#include "kilter/io/file.h"

namespace kilter {

/// One topic of a recording. Several publishers may share one.
struct BagTopic {
  std::string name;
  std::string type;  ///< as the bag has it: "sensor_msgs/msg/PointCloud2"
  MessageEncoding encoding = MessageEncoding::kRos1;
  RosType ros_type = RosType::kOther;  ///< kOther where the encoding is none that kilter reads
  std::size_t messages = 0;            ///< counted by the walk
};

/// Where a message lies: meaningful to the reader that found it.
struct MessagePlace {
  static constexpr std::uint32_t kNoChunk = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t chunk = kNoChunk;  ///< number of the packed chunk that holds it
  std::uint64_t offset = 0;        ///< in the unpacked chunk, else in the file; sqlite: the row
  std::uint64_t size = 0;          ///< [bytes]
};

/// A message's bytes, and whoever keeps them.
struct MessageBytes {
  std::shared_ptr<const ByteBuffer> owner;
  std::string_view bytes;
  std::uint64_t packed_bytes = 0;  ///< what it was unpacked from, as part of its chunk or alone; else its own
};

/// A message as the walk comes by it.
struct PassingMessage {
  std::size_t topic = 0;    ///< index into topics()
  std::int64_t log_ns = 0;  ///< when it was recorded
  MessagePlace place;       ///< of the whole message
  std::string_view bytes;   ///< the whole message, or its first bytes_wanted(type); valid during the visit
};

/// A recording has some hundred topics at most.
inline constexpr std::size_t kMaxTopics = 4096;

/// How much a walk may unpack. Once it is used up, packed chunks are passed over whose index tells how many messages of
/// which topic they hold, so that a recording's beginning is read and the rest is counted.
class UnpackingBudget {
 public:
  /// Without end.
  UnpackingBudget() = default;
  /// \param bz2_bytes  what bzip2 may unpack to; of LZ4 and Zstandard, which are that much faster, 30 times as much
  explicit UnpackingBudget(std::uint64_t bz2_bytes) : left_(bz2_bytes) {}

  /// Takes the cost of one chunk. \return whether anything was left for it.
  bool take(Packing packing, std::uint64_t unpacked_bytes);

 private:
  std::uint64_t left_ = std::numeric_limits<std::uint64_t>::max();
};

using MessageVisitor = std::function<void(const PassingMessage&)>;

/// One file of a recording. Never held whole.
class BagReader {
 public:
  BagReader() = default;
  BagReader(const BagReader&) = delete;
  BagReader(BagReader&&) = delete;
  BagReader& operator=(const BagReader&) = delete;
  BagReader& operator=(BagReader&&) = delete;
  virtual ~BagReader() = default;

  /// Goes once through all messages, in the order of the file, counts each, and shows those of a type that kilter
  /// reads. Chunks that hold none of them are passed over where an index says so, and so are those for which nothing of
  /// the budget is left. A recording that was cut short is read as far as it is whole, and notes() says so.
  ///
  /// \return  kParse, kTruncated, kUnsupported (also: the budget is used up and no index tells what a chunk holds),
  ///          kIo, kOutOfMemory with the byte offset.
  [[nodiscard]] virtual Expected<void> walk(const MessageVisitor& visit, UnpackingBudget& budget) = 0;

  /// The same to the end, however much there is to unpack.
  [[nodiscard]] Expected<void> walk_all(const MessageVisitor& visit) {
    UnpackingBudget without_end;
    return walk(visit, without_end);
  }

  /// Reads one message again. May be called from several threads at once. \return what walk fails with.
  [[nodiscard]] virtual Expected<MessageBytes> read(const MessagePlace& place) const = 0;

  /// The place of a message, for messages to people: "run.bag: byte 4096".
  [[nodiscard]] virtual std::string where(const MessagePlace& place) const = 0;

  [[nodiscard]] const std::vector<BagTopic>& topics() const { return topics_; }
  /// What a person should know and that is no error.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

 protected:
  /// The topic of this name, type and encoding, made if there is none yet; its ros_type is set here.
  /// \return  its index; or kUnsupported beyond kMaxTopics.
  [[nodiscard]] Expected<std::size_t> find_or_add(BagTopic topic, const std::string& where);

  /// For a chunk behind the budget of which no index tells: what is read must stay a beginning without holes.
  [[nodiscard]] static tl::unexpected<Error> refuse_to_pass_over(std::string where);

  std::vector<BagTopic> topics_;
  std::vector<std::string> notes_;
};

}  // namespace kilter
