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
