// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/random_access_file.h"

#include <gtest/gtest.h>

#include <utility>

#include "kilter/base/rng.h"
#include "testing/allocation_watch.h"
#include "testing/temp_folder.h"

namespace kilter {
namespace {

std::string numbered(std::size_t size) {
  std::string bytes(size, '\0');
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>(i * 7 + i / 251);
  return bytes;
}

TEST(RandomAccessFile, ReadsAnyPieceThatIsThere) {
  const kilter_testing::TempFolder folder;
  const std::string bytes = numbered(1000);
  const auto opened = RandomAccessFile::open(folder.write("file", bytes));
  ASSERT_TRUE(opened);
  const RandomAccessFile in_memory = RandomAccessFile::over(bytes, "f");
  for (const RandomAccessFile* file : {&*opened, &in_memory}) {
    EXPECT_EQ(file->size(), 1000U);
    EXPECT_EQ(file->read(0, 1000)->view(), bytes);
    EXPECT_EQ(file->read(990, 10)->view(), bytes.substr(990));
    EXPECT_EQ(file->read(1000, 0)->view(), "");
  }
}

TEST(RandomAccessFile, AllocatesNothingForBytesThatAreNotThere) {
  const std::string bytes = numbered(1000);
  const RandomAccessFile file = RandomAccessFile::over(bytes, "f");
  for (const auto& [offset, size] : {std::pair<std::uint64_t, std::uint64_t>{0, 1001},
                                     {1001, 0},
                                     {999, UINT64_MAX},
                                     {UINT64_MAX, 1},
                                     {UINT64_MAX, UINT64_MAX}}) {
    kilter_testing::largest_allocation() = 0;
    const auto refused = file.read(offset, size);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kTruncated);
    EXPECT_LE(kilter_testing::largest_allocation(), 512U);
  }
}

TEST(RandomAccessFile, RefusesWhatIsNoFile) {
  const kilter_testing::TempFolder folder;
  EXPECT_EQ(RandomAccessFile::open(folder.path()).error().code, ErrorCode::kIo);
  EXPECT_EQ(RandomAccessFile::open(folder.path() / "none").error().code, ErrorCode::kNotFound);
}

TEST(RandomAccessFile, NoticesThatItShrank) {
  const kilter_testing::TempFolder folder;
  const auto path = folder.write("file", numbered(1000));
  const auto file = RandomAccessFile::open(path);
  std::filesystem::resize_file(path, 10);
  EXPECT_EQ(file->read(0, 1000).error().code, ErrorCode::kTruncated);
}

TEST(ByteWindow, ShowsTheSameBytesWhateverWasLookedAtBefore) {
  const std::string bytes = numbered(200000);
  const RandomAccessFile file = RandomAccessFile::over(bytes, "f");
  ByteWindow in_file(file, 100, 190000);
  ByteWindow in_memory(std::string_view(bytes).substr(0, 190000), "f");
  Rng rng(1, 2);
  for (int i = 0; i < 2000; ++i) {
    const std::uint64_t position = rng.below(200100);
    const std::uint64_t size = rng.below(i % 10 == 0 ? 150000 : 100);
    const auto seen = in_file.look(position, size);
    EXPECT_EQ(seen.has_value(), position >= 100 && position + size <= 190000);
    if (!seen) continue;
    EXPECT_EQ(*seen, std::string_view(bytes).substr(position, size));
    EXPECT_EQ(*seen, *in_memory.look(position, size));
  }
  EXPECT_FALSE(in_file.look(150, UINT64_MAX));
  EXPECT_FALSE(in_file.look(UINT64_MAX, 2));
}

}  // namespace
}  // namespace kilter
