// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/mcap.h"

#include <gmock/gmock.h>

#include "testing/allocation_watch.h"
#include "testing/bag_walk.h"

namespace kilter {
namespace {

using kilter_testing::BagPacking;
using kilter_testing::largest_allocation;
using kilter_testing::mcap_bytes;
using kilter_testing::RosDialect;
using kilter_testing::small_drive;
using kilter_testing::Walked;

Expected<Walked> walk(const std::string& bytes) {
  return kilter_testing::walk_all(open_mcap(RandomAccessFile::over(bytes, "run.mcap")));
}

std::vector<std::string> read_ones(const std::vector<kilter_testing::RecordedMessage>& messages) {
  std::vector<std::string> bytes;
  for (const auto& message : messages) {
    if (message.topic != "/image") bytes.push_back(message.bytes);
  }
  return bytes;
}

TEST(Mcap, GivesBackWhatWasRecordedHoweverItIsPacked) {
  const auto messages = small_drive(RosDialect::kCdrLittle);
  for (const BagPacking packing : {BagPacking::kNone, BagPacking::kLz4, BagPacking::kZstd}) {
    for (const bool closed : {true, false}) {
      for (const std::size_t per_chunk : {0U, 1U, 3U, 100U}) {
        SCOPED_TRACE(per_chunk);
        const auto walked =
            walk(mcap_bytes(messages, {.packing = packing, .messages_per_chunk = per_chunk, .is_closed = closed}));
        ASSERT_TRUE(walked) << to_string(walked.error());
        EXPECT_EQ(walked->messages, read_ones(messages));
        EXPECT_EQ(walked->counts, (std::map<std::string, std::size_t>{{"/odom", 8}, {"/points", 4}, {"/image", 24}}));
        EXPECT_EQ(walked->notes.size(), closed ? 0U : 1U);
      }
    }
  }
}

TEST(Mcap, ReadsAsFarAsARecordingIsWhole) {
  const auto messages = small_drive(RosDialect::kCdrLittle);
  const auto all = read_ones(messages);
  for (const BagPacking packing : {BagPacking::kNone, BagPacking::kZstd}) {
    for (const std::size_t per_chunk : {0U, 2U}) {
      const std::string bytes = mcap_bytes(messages, {.packing = packing, .messages_per_chunk = per_chunk});
      std::size_t before = 0;
      for (std::size_t length = 8; length < bytes.size(); ++length) {
        const auto walked = walk(bytes.substr(0, length));
        ASSERT_TRUE(walked) << length << to_string(walked.error());
        ASSERT_LE(walked->messages.size(), all.size());
        EXPECT_TRUE(std::equal(walked->messages.begin(), walked->messages.end(), all.begin()));
        EXPECT_GE(walked->messages.size(), before);
        before = walked->messages.size();
      }
      EXPECT_EQ(before, all.size());
    }
  }
}

TEST(Mcap, TellsEncodingsApart) {
  auto messages = small_drive(RosDialect::kRos1, 1);
  EXPECT_EQ(walk(mcap_bytes(messages, {.mcap_encoding = "ros1"}))->messages, read_ones(messages));
  const auto other = walk(mcap_bytes(messages, {.mcap_encoding = "protobuf"}));
  ASSERT_TRUE(other);
  EXPECT_TRUE(other->messages.empty());
  EXPECT_EQ(other->counts.at("/points"), 1U);
}

TEST(Mcap, RefusesWhatIsNoMcapOrDamaged) {
  EXPECT_EQ(walk("").error().code, ErrorCode::kParse);
  EXPECT_EQ(walk("not an MCAP file").error().code, ErrorCode::kParse);
  EXPECT_EQ(walk(std::string("\x89MCAP9\r\n", 8)).error().code, ErrorCode::kUnsupported);
  const auto messages = small_drive(RosDialect::kCdrLittle);
  EXPECT_EQ(walk(mcap_bytes(messages, {.packing = BagPacking::kBz2})).error().code, ErrorCode::kUnsupported);
  std::string bytes = mcap_bytes(messages, {.packing = BagPacking::kLz4, .messages_per_chunk = 100});
  const std::size_t magic = bytes.find("\x04\x22\x4D\x18");
  ASSERT_NE(magic, std::string::npos);
  // In the middle of the records: LZ4 unpacks it to something else, which the checksum tells.
  bytes[magic + 400] = static_cast<char>(bytes[magic + 400] ^ 0x20);
  const auto damaged = walk(bytes);
  ASSERT_FALSE(damaged);
  EXPECT_EQ(damaged.error().code, ErrorCode::kParse);
  EXPECT_THAT(damaged.error().where, testing::HasSubstr("byte " + std::to_string(magic)));
}

TEST(Mcap, AllocatesNothingForLengthsThatAreNotThere) {
  const std::string bytes = mcap_bytes(small_drive(RosDialect::kCdrLittle, 1), {.packing = BagPacking::kZstd});
  for (std::size_t at = 8; at + 8 <= bytes.size(); ++at) {
    for (const std::string& claim :
         {std::string("\xF0\xFF\xFF\xFF"), std::string("\xFF\xFF\xFF\xFF\xFF\xFF\xFF\x7F")}) {
      std::string bomb = bytes;
      bomb.replace(at, claim.size(), claim);
      largest_allocation() = 0;
      static_cast<void>(walk(bomb));
      EXPECT_LE(largest_allocation(), 1100 * bytes.size()) << at;
    }
  }
}

}  // namespace
}  // namespace kilter
