// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/decompress.h"

#include <gtest/gtest.h>

#include "testing/allocation_watch.h"
#include "testing/bag_bytes.h"

namespace kilter {
namespace {

using kilter_testing::largest_allocation;
using kilter_testing::zstd_bytes;

TEST(Unpack, RefusesClaimsBeyondItsBoundsBeforeItAllocates) {
  const std::string packed = zstd_bytes(std::string(100000, 'x'));
  for (const Packing packing : {Packing::kBz2, Packing::kLz4, Packing::kZstd}) {
    for (const std::uint64_t claim : {std::uint64_t{1} << 31, std::uint64_t{1} << 62, std::uint64_t{UINT64_MAX}}) {
      largest_allocation() = 0;
      const auto refused = unpack(packing, packed, claim, "f");
      ASSERT_FALSE(refused);
      EXPECT_EQ(refused.error().code, ErrorCode::kUnsupported);
      EXPECT_LE(largest_allocation(), 4096U);
    }
  }
}

TEST(Unpack, BoundsMemoryByTheSizeOfWhatIsPacked) {
  EXPECT_EQ(most_unpacked(0), kFreeUnpackedBytes);
  EXPECT_EQ(most_unpacked(1000), 1'000'000U);
  EXPECT_EQ(most_unpacked(10'000'000), (1U << 27) + 30'000'000U);
  EXPECT_EQ(most_unpacked(1'000'000'000), kMaxUnpackedBytes);
  EXPECT_EQ(most_unpacked(UINT64_MAX), kMaxUnpackedBytes);
  // Zeros pack so well that no recording does: 1 MiB in some 50 bytes.
  const std::string bomb = zstd_bytes(std::string(1 << 20, '\0'));
  EXPECT_EQ(unpack_zstd_frame(bomb, "f").error().code, ErrorCode::kUnsupported);
}

TEST(Unpack, RefusesAnotherSizeThanWasPromised) {
  const std::string bytes(1000, 'x');
  const std::string packed = zstd_bytes(bytes);
  EXPECT_EQ(unpack(Packing::kZstd, packed, 1000, "f")->view(), bytes);
  for (const std::uint64_t size : {0U, 999U, 1001U}) {
    EXPECT_EQ(unpack(Packing::kZstd, packed, size, "f").error().code, ErrorCode::kParse);
  }
  for (const Packing packing : {Packing::kBz2, Packing::kLz4}) {
    EXPECT_EQ(unpack(packing, packed, 1000, "f").error().code, ErrorCode::kParse);
    EXPECT_EQ(unpack(packing, "", 1000, "f").error().code, ErrorCode::kParse);
  }
}

TEST(UnpackZstdFrame, TakesTheSizeFromTheFrame) {
  const std::string packed = zstd_bytes("a message");
  EXPECT_TRUE(is_zstd_frame(packed));
  EXPECT_EQ(unpack_zstd_frame(packed, "f")->view(), "a message");
  for (std::size_t length = 0; length < packed.size(); ++length) {
    EXPECT_FALSE(unpack_zstd_frame(packed.substr(0, length), "f"));
  }
}

}  // namespace
}  // namespace kilter
