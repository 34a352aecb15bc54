// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/chunk_store.h"

#include <bzlib.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>

#include "testing/bag_bytes.h"
#include "testing/temp_folder.h"

namespace kilter {
namespace {

using kilter_testing::TempFolder;
using kilter_testing::zstd_bytes;

constexpr std::size_t kMb = std::size_t{1} << 20;

// Words that no bytes repeat within a megabyte, so that they pack well, but not as well as nothing does.
std::string words(std::size_t bytes) {
  std::string text;
  for (std::size_t i = 0; text.size() < bytes; ++i) text += std::to_string(i * i) + ",";
  text.resize(bytes);
  return text;
}

std::string bz2_bytes(std::string bytes) {
  auto size = static_cast<unsigned>(bytes.size() + bytes.size() / 100 + 600);
  std::string packed(size, '\0');
  EXPECT_EQ(BZ2_bzBuffToBuffCompress(packed.data(), &size, bytes.data(), static_cast<unsigned>(bytes.size()), 9, 0, 0),
            BZ_OK);
  packed.resize(size);
  return packed;
}

// A file that holds the same packed chunk as often as wanted.
struct Chunks {
  TempFolder folder;
  std::string packed;
  ChunkStore store;

  Chunks(std::string packed_bytes, std::size_t file_bytes)
      : packed(std::move(packed_bytes)), store(open(folder, packed, file_bytes)) {}

  static RandomAccessFile open(const TempFolder& folder, std::string bytes, std::size_t file_bytes) {
    bytes.resize(std::max(bytes.size(), file_bytes));
    return RandomAccessFile::open(folder.write("f", bytes)).value();
  }

  Expected<std::uint32_t> add(Packing packing, std::size_t unpacked_bytes) {
    return store.add({packing, 0, packed.size(), unpacked_bytes, 0});
  }
};

TEST(ChunkStore, KeepsWhatItHasUnpackedUpToABound) {
  Chunks chunks(zstd_bytes(words(kMb)), 0);
  for (std::uint32_t i = 0; i < 2 * kMostHeldBytes / kMb; ++i) ASSERT_EQ(chunks.add(Packing::kZstd, kMb).value(), i);
  const auto address = [&](std::uint32_t number) { return chunks.store.chunk(number).value().get(); };
  const auto first = chunks.store.chunk(0).value();
  for (std::uint32_t i = 1; i < kMostHeldBytes / kMb; ++i) static_cast<void>(address(i));
  EXPECT_EQ(address(0), first.get()) << "all of them fit";
  static_cast<void>(address(kMostHeldBytes / kMb));
  EXPECT_EQ(address(0), first.get()) << "the one that was asked for last stays longest";
  for (std::uint32_t i = 1; i <= kMostHeldBytes / kMb; ++i) static_cast<void>(address(i));
  EXPECT_NE(address(0), first.get());
}

TEST(ChunkStore, RefusesMoreThanAFileOfThatSizeCanMean) {
  Chunks chunks(bz2_bytes(std::string(kMb, 'x')), 10'000);
  const std::size_t most = most_of_bz2(10'000) / kMb;
  for (std::size_t i = 0; i < most; ++i) ASSERT_TRUE(chunks.add(Packing::kBz2, kMb)) << i;
  const auto refused = chunks.add(Packing::kBz2, kMb);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kUnsupported);
  EXPECT_TRUE(chunks.add(Packing::kLz4, kMb)) << "what is unpacked quickly is bounded chunk by chunk";
}

TEST(ChunkStore, EndsWhereTheSameChunkIsUnpackedOverAndOver) {
  const std::size_t large = kMostHeldBytes + kMb;
  const std::string part = words(300'000);
  std::string text;
  while (text.size() < large) text += part;
  text.resize(large);
  Chunks chunks(zstd_bytes(text), 0);
  ASSERT_LT(chunks.packed.size(), 400'000U);
  const auto number = chunks.add(Packing::kZstd, large).value();
  std::size_t times = 0;
  while (times < 1000 && chunks.store.chunk(number)) ++times;
  EXPECT_EQ(times, most_unpacked_again(chunks.packed.size()) / large + 1);
  EXPECT_EQ(chunks.store.chunk(number).error().code, ErrorCode::kUnsupported);
}

}  // namespace
}  // namespace kilter
