// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/temporary_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <cstring>
#include <thread>
#include <vector>

namespace kilter {
namespace {

std::vector<std::byte> some_bytes(std::size_t count, int salt) {
  std::vector<std::byte> bytes(count);
  for (std::size_t i = 0; i < count; ++i)
    bytes[i] = static_cast<std::byte>((i * 31 + static_cast<std::size_t>(salt)) & 0xFF);
  return bytes;
}

class TemporaryFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (std::filesystem::temp_directory_path() / "kilter-test-XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_;
};

TEST_F(TemporaryFileTest, GivesBackWhatThreadsWroteAndLeavesNothingBehind) {
  {
    const auto file = temporary_file_in(folder_);
    std::vector<std::jthread> threads;
    std::vector<bool> same(4, false);
    for (int t = 0; t < 4; ++t) {
      threads.emplace_back([&, t] {
        bool all = true;
        for (int i = 0; i < 20; ++i) {
          const auto bytes = some_bytes(1000 + static_cast<std::size_t>(i), t);
          const auto place = file->write(bytes);
          std::vector<std::byte> again(bytes.size());
          all = all && place && file->read(*place, again) && again == bytes;
        }
        static std::mutex mutex;
        const std::scoped_lock lock(mutex);
        same[static_cast<std::size_t>(t)] = all;
      });
    }
    threads.clear();
    EXPECT_EQ(same, std::vector<bool>(4, true));
    EXPECT_TRUE(std::filesystem::is_empty(folder_)) << "the file has a name";
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST_F(TemporaryFileTest, SaysWhereItCannotBe) {
  const auto file = temporary_file_in(folder_ / "absent");
  const auto place = file->write(some_bytes(10, 0));
  ASSERT_FALSE(place.has_value());
  EXPECT_EQ(place.error().code, ErrorCode::kIo);
  EXPECT_EQ(place.error().where, (folder_ / "absent").string());
}

TEST_F(TemporaryFileTest, TellsThatNoMoreFitsAndThatBytesAreMissing) {
  const auto file = temporary_file_in(folder_);
  ASSERT_TRUE(file->write(some_bytes(1000, 1)).has_value());
  std::vector<std::byte> beyond(500);
  EXPECT_EQ(file->read({800, 500}, beyond).error().code, ErrorCode::kTruncated);
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{4096, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const auto full = file->write(some_bytes(10000, 2));
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  ASSERT_FALSE(full.has_value());
  EXPECT_EQ(full.error().code, ErrorCode::kNoSpace);
}

}  // namespace
}  // namespace kilter
