// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/rosbag2_sqlite.h"

#include <gmock/gmock.h>

#include "testing/bag_walk.h"
#include "testing/temp_folder.h"

namespace kilter {
namespace {

using kilter_testing::RosDialect;
using kilter_testing::small_drive;
using kilter_testing::walk_all;

TEST(Rosbag2Sqlite, GivesBackWhatWasRecordedAndWritesNothing) {
  const kilter_testing::TempFolder folder;
  const auto messages = small_drive(RosDialect::kCdrLittle);
  const auto file = folder.path() / "run #1%.db3";
  kilter_testing::write_sqlite_bag(file, messages);
  const auto walked = walk_all(open_rosbag2_sqlite(file));
  ASSERT_TRUE(walked) << to_string(walked.error());
  EXPECT_EQ(walked->counts, (std::map<std::string, std::size_t>{{"/odom", 8}, {"/points", 4}, {"/image", 24}}));
  std::vector<std::string> expected;
  for (const auto& message : messages) {
    if (message.topic != "/image") expected.push_back(message.bytes);
  }
  EXPECT_EQ(walked->messages, expected);
  EXPECT_TRUE(walked->notes.empty());
  const auto entries = std::filesystem::directory_iterator(folder.path());
  EXPECT_EQ(std::distance(entries, std::filesystem::directory_iterator()), 1);
}

TEST(Rosbag2Sqlite, TellsOfMessagesThatAKilledRecorderLeftBeside) {
  const kilter_testing::TempFolder folder;
  kilter_testing::write_sqlite_bag(folder.path() / "run.db3", small_drive(RosDialect::kCdrLittle, 1));
  static_cast<void>(folder.write("run.db3-wal", "some"));
  EXPECT_EQ(walk_all(open_rosbag2_sqlite(folder.path() / "run.db3"))->notes.size(), 1U);
}

TEST(Rosbag2Sqlite, AnswersEveryFileCutShortOrDamaged) {
  const kilter_testing::TempFolder folder;
  kilter_testing::write_sqlite_bag(folder.path() / "run.db3", small_drive(RosDialect::kCdrLittle));
  const std::string bytes = kilter_testing::bytes_of(folder.path() / "run.db3");
  for (std::size_t length = 0; length < bytes.size(); length += 509) {
    const auto cut = walk_all(open_rosbag2_sqlite(folder.write("cut.db3", bytes.substr(0, length))));
    // Never a cloud whose last points were filled up by zeros.
    ASSERT_FALSE(cut) << length;
    EXPECT_THAT(cut.error().where, testing::HasSubstr("cut.db3"));
  }
  for (std::size_t at = 0; at < bytes.size(); at += 211) {
    std::string broken = bytes;
    broken[at] = static_cast<char>(broken[at] ^ 0xFF);
    static_cast<void>(walk_all(open_rosbag2_sqlite(folder.write("broken.db3", broken))));
  }
}

TEST(Rosbag2Sqlite, RefusesWhatIsNoBag) {
  const kilter_testing::TempFolder folder;
  EXPECT_EQ(walk_all(open_rosbag2_sqlite(folder.path() / "none.db3")).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(walk_all(open_rosbag2_sqlite(folder.path())).error().code, ErrorCode::kIo);
  EXPECT_EQ(walk_all(open_rosbag2_sqlite(folder.write("text.db3", "no database, but long enough to be read as one")))
                .error()
                .code,
            ErrorCode::kParse);
  EXPECT_EQ(walk_all(open_rosbag2_sqlite(folder.write("empty.db3", ""))).error().code, ErrorCode::kParse);
}

}  // namespace
}  // namespace kilter
