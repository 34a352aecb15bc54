// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/base/rng.h"

#include <gtest/gtest.h>

namespace kilter {
namespace {

TEST(Rng, RepeatsForTheSameKeyAndDiffersForOthers) {
  Rng a(7, 1);
  Rng b(7, 1);
  Rng c(7, 2);
  EXPECT_EQ(a.bits(), b.bits());
  EXPECT_NE(a.bits(), c.bits());
}

TEST(Rng, MomentsOfUniformAndNormalAreRight) {
  Rng rng(1, 0);
  double uniform_sum = 0.0;
  double normal_sum = 0.0;
  double normal_squares = 0.0;
  constexpr int kDraws = 200000;
  for (int i = 0; i < kDraws; ++i) {
    const double u = rng.uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    uniform_sum += u;
    const double z = rng.normal();
    normal_sum += z;
    normal_squares += z * z;
  }
  EXPECT_NEAR(uniform_sum / kDraws, 0.5, 0.003);
  EXPECT_NEAR(normal_sum / kDraws, 0.0, 0.01);
  EXPECT_NEAR(normal_squares / kDraws, 1.0, 0.02);
}

TEST(Rng, BelowStaysBelowAndReachesAll) {
  Rng rng(3, 0);
  std::array<int, 5> hits{};
  for (int i = 0; i < 1000; ++i) ++hits.at(rng.below(5));
  for (const int count : hits) EXPECT_GT(count, 100);
}

}  // namespace
}  // namespace kilter
