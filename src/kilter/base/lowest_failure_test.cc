// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/base/lowest_failure.h"

#include <gtest/gtest.h>

#include <string>

#include "kilter/base/parallel.h"

namespace kilter {
namespace {

TEST(LowestFailure, IsNoneWhereNothingFailed) {
  const LowestFailure failure;
  EXPECT_FALSE(failure.is_before(1'000'000));
  EXPECT_TRUE(failure.result());
}

TEST(LowestFailure, TheLowestStaysInWhateverOrderTheyCome) {
  LowestFailure failure;
  for (const std::size_t i : {7, 3, 5}) failure.keep(i, {ErrorCode::kParse, std::to_string(i), {}, {}});
  EXPECT_TRUE(failure.is_before(4));
  EXPECT_FALSE(failure.is_before(3));
  EXPECT_EQ(failure.result().error().message, "3");
}

TEST(LowestFailure, IsTheSameForAnyNumberOfThreads) {
  for (const int threads : {1, 2, 8}) {
    for (int time = 0; time < 50; ++time) {
      LowestFailure failure;
      parallel_for(1000, {.threads = threads}, [&](std::size_t i) {
        if (failure.is_before(i)) return;
        if (i % 100 == 42) failure.keep(i, {ErrorCode::kParse, std::to_string(i), {}, {}});
      });
      EXPECT_EQ(failure.result().error().message, "42");
    }
  }
}

}  // namespace
}  // namespace kilter
