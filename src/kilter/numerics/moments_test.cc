// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/numerics/moments.h"

#include <vector>

#include <gtest/gtest.h>

#include "kilter/base/rng.h"

namespace kilter {
namespace {

std::vector<double> random_values(std::size_t count, double offset) {
  Rng rng(11, count);
  std::vector<double> values(count);
  for (double& x : values) x = offset + rng.uniform();
  return values;
}

TEST(Moments, AreThoseOfTheNumbersThemselves) {
  const std::vector<double> values = {1.0, 2.0, 3.0, 6.0};
  const Moments moments = moments_of(values);
  EXPECT_EQ(moments.count, 4);
  EXPECT_DOUBLE_EQ(moments.mean, 3.0);
  EXPECT_DOUBLE_EQ(moments.variance(), 3.5);
}

TEST(Moments, MergingPartsEqualsTakingAllAtOnce) {
  const std::vector<double> values = random_values(1001, 0.0);
  const Moments whole = moments_of(values);
  for (const std::size_t cut : {std::size_t{0}, std::size_t{1}, std::size_t{400}, values.size()}) {
    const std::span<const double> all(values);
    Moments merged = moments_of(all.first(cut));
    merged.merge(moments_of(all.subspan(cut)));
    EXPECT_EQ(merged.count, whole.count);
    EXPECT_NEAR(merged.mean, whole.mean, 1e-15);
    EXPECT_NEAR(merged.variance(), whole.variance(), 1e-15);
  }
}

TEST(Moments, KeepTheVarianceOfNumbersFarFromZero) {
  const Moments near = moments_of(random_values(5000, 0.0));
  const Moments far = moments_of(random_values(5000, 0x1.0p26));  // steps of 2^-26 are left of each number
  EXPECT_NEAR(far.variance(), near.variance(), 1e-8);
}

TEST(Moments, OfEqualNumbersHaveExactlyNoVariance) {
  const std::vector<double> values(1000, 0.1);
  Moments moments = moments_of(values);
  moments.merge(moments_of(values));
  EXPECT_EQ(moments.mean, 0.1);
  EXPECT_EQ(moments.variance(), 0.0);
}

TEST(Moments, OfNothingAndOfOneNumberHaveNoVariance) {
  EXPECT_EQ(Moments{}.variance(), 0.0);
  const std::vector<double> one = {7.0};
  EXPECT_EQ(moments_of(one).mean, 7.0);
  EXPECT_EQ(moments_of(one).variance(), 0.0);
}

}  // namespace
}  // namespace kilter
