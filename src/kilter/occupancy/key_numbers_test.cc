// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/occupancy/key_numbers.h"

#include <gtest/gtest.h>

#include <map>

#include "kilter/base/rng.h"

namespace kilter {
namespace {

TEST(KeyNumbers, CountKeysInTheOrderInWhichTheyFirstCome) {
  KeyNumbers numbers;
  std::map<std::uint64_t, std::uint32_t> expected;
  Rng rng(3, 0);
  for (int i = 0; i < 20000; ++i) {
    const auto key = static_cast<std::uint64_t>(rng.uniform(0.0, 5000.0)) << (i % 2 == 0 ? 42 : 0);
    const auto number = expected.try_emplace(key, static_cast<std::uint32_t>(expected.size())).first->second;
    ASSERT_EQ(numbers.find_or_add(key), number);
    ASSERT_EQ(numbers.find_or_add(key), number);  // again, as the last one
  }
  ASSERT_EQ(numbers.size(), expected.size());
  EXPECT_GT(numbers.size(), 5000U);
  for (const auto& [key, number] : expected) {
    EXPECT_EQ(numbers.keys()[number], key);
    EXPECT_EQ(numbers.find(key), number);
  }
  EXPECT_EQ(numbers.find(std::uint64_t{1} << 63), KeyNumbers::kNone);
  EXPECT_EQ(KeyNumbers().find(0), KeyNumbers::kNone);
}

}  // namespace
}  // namespace kilter
