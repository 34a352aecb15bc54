// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/rosbag1.h"

#include <gmock/gmock.h>

#include "testing/allocation_watch.h"
#include "testing/bag_walk.h"

namespace kilter {
namespace {

using kilter_testing::BagLayout;
using kilter_testing::BagPacking;
using kilter_testing::largest_allocation;
using kilter_testing::rosbag1_bytes;
using kilter_testing::RosDialect;
using kilter_testing::small_drive;
using kilter_testing::Walked;

Expected<Walked> walk(const std::string& bytes) {
  return kilter_testing::walk_all(open_rosbag1(RandomAccessFile::over(bytes, "run.bag")));
}

std::vector<std::string> read_ones(const std::vector<kilter_testing::RecordedMessage>& messages) {
  std::vector<std::string> bytes;
  for (const auto& message : messages) {
    if (message.topic != "/image") bytes.push_back(message.bytes);
  }
  return bytes;
}

TEST(Rosbag1, GivesBackWhatWasRecordedHoweverItIsPacked) {
  const auto messages = small_drive(RosDialect::kRos1);
  for (const BagPacking packing : {BagPacking::kNone, BagPacking::kBz2, BagPacking::kLz4}) {
    for (const bool closed : {true, false}) {
      for (const std::size_t per_chunk : {1U, 3U, 100U}) {
        SCOPED_TRACE(per_chunk);
        const auto walked =
            walk(rosbag1_bytes(messages, {.packing = packing, .messages_per_chunk = per_chunk, .is_closed = closed}));
        ASSERT_TRUE(walked) << to_string(walked.error());
        EXPECT_EQ(walked->messages, read_ones(messages));
        EXPECT_EQ(walked->counts, (std::map<std::string, std::size_t>{{"/odom", 8}, {"/points", 4}, {"/image", 24}}));
        EXPECT_EQ(walked->notes.size(), closed ? 0U : 1U);
      }
    }
  }
}

TEST(Rosbag1, ReadsAsFarAsARecordingIsWhole) {
  const auto messages = small_drive(RosDialect::kRos1);
  const auto all = read_ones(messages);
  for (const BagPacking packing : {BagPacking::kNone, BagPacking::kLz4}) {
    for (const bool closed : {true, false}) {
      const std::string bytes = rosbag1_bytes(messages, {.packing = packing, .is_closed = closed});
      std::size_t before = 0;
      for (std::size_t length = 0; length < bytes.size(); ++length) {
        const auto walked = walk(bytes.substr(0, length));
        if (!walked) {
          EXPECT_THAT(walked.error().where, testing::StartsWith("run.bag"));
          EXPECT_LT(length, 5000U) << to_string(walked.error());
          continue;
        }
        ASSERT_LE(walked->messages.size(), all.size());
        EXPECT_TRUE(std::equal(walked->messages.begin(), walked->messages.end(), all.begin()));
        EXPECT_GE(walked->messages.size(), before);
        before = walked->messages.size();
      }
      EXPECT_EQ(before, all.size());
    }
  }
}

TEST(Rosbag1, RefusesWhatIsNoBagOrAnother) {
  const auto refused = [](const std::string& bytes) { return walk(bytes).error(); };
  EXPECT_EQ(refused("").code, ErrorCode::kParse);
  EXPECT_EQ(refused("not a bag at all").code, ErrorCode::kParse);
  EXPECT_EQ(refused("#ROSBAG V1.2\n").code, ErrorCode::kUnsupported);
  EXPECT_EQ(refused("#ROSBAG V2.0\n").code, ErrorCode::kTruncated);
  std::string packed_otherwise = rosbag1_bytes(small_drive(RosDialect::kRos1), {.packing = BagPacking::kZstd});
  EXPECT_EQ(refused(packed_otherwise).code, ErrorCode::kUnsupported);
}

TEST(Rosbag1, SaysWhereAClosedBagIsDamaged) {
  std::string bytes = rosbag1_bytes(small_drive(RosDialect::kRos1), {.packing = BagPacking::kLz4});
  const std::size_t magic = bytes.find("\x04\x22\x4D\x18");
  ASSERT_NE(magic, std::string::npos);
  std::string broken = bytes;
  broken[magic + 20] = static_cast<char>(broken[magic + 20] ^ 0xFF);
  const auto damaged = walk(broken);
  ASSERT_FALSE(damaged);
  EXPECT_EQ(damaged.error().code, ErrorCode::kParse);
  EXPECT_THAT(damaged.error().where, testing::HasSubstr("byte " + std::to_string(magic)));
  // The first chunk's length.
  broken = bytes;
  broken[magic - 1] = '\x70';
  const auto too_long = walk(broken);
  ASSERT_FALSE(too_long);
  EXPECT_EQ(too_long.error().code, ErrorCode::kParse);
}

TEST(Rosbag1, AllocatesNothingForLengthsThatAreNotThere) {
  const std::string bytes = rosbag1_bytes(small_drive(RosDialect::kRos1, 1), {.packing = BagPacking::kLz4});
  for (std::size_t at = 13; at + 4 <= bytes.size(); ++at) {
    if (at > 200 && at < 4100) continue;  // the header's padding
    std::string bomb = bytes;
    bomb.replace(at, 4, "\xF0\xFF\xFF\xFF");
    largest_allocation() = 0;
    static_cast<void>(walk(bomb));
    EXPECT_LE(largest_allocation(), 1100 * bytes.size()) << at;
  }
}

}  // namespace
}  // namespace kilter
