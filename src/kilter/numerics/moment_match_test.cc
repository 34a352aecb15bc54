// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/numerics/moment_match.h"

#include <cmath>

#include <gtest/gtest.h>

namespace kilter {
namespace {

TEST(TruncatedExponentialVariance, HasTheKnownValues) {
  const double table[][2] = {{0.05, 0.00250}, {0.10, 0.00996}, {0.20, 0.0350},
                             {0.30, 0.0603},  {0.40, 0.0774},  {0.50, 0.0833}};
  for (const auto& [mean, variance] : table) {
    EXPECT_NEAR(truncated_exponential_variance(mean), variance, 5e-3 * variance) << mean;
    EXPECT_NEAR(truncated_exponential_variance(1.0 - mean), truncated_exponential_variance(mean), 1e-13);
  }
}

TEST(TruncatedExponentialVariance, MatchesItsClosedFormInTheRate) {
  for (const double k : {0.5, 2.0, 8.0, 30.0, 1000.0}) {
    const double mean = 1.0 / k - 1.0 / std::expm1(k);
    const double sinh = std::sinh(0.5 * std::min(k, 1000.0));
    const double variance = 1.0 / (k * k) - 0.25 / (sinh * sinh);
    EXPECT_NEAR(truncated_exponential_variance(mean), variance, 1e-12 * variance / std::min(1.0, k * k)) << k;
  }
}

TEST(TruncatedExponentialVariance, NearTheEndsIsTheSquareOfTheMean) {
  EXPECT_NEAR(truncated_exponential_variance(1e-6), 1e-12, 1e-24);
}

TEST(ShapeFromMoments, TellsTheFamilysMembersApart) {
  EXPECT_EQ(shape_from_moments(0.2, 0.01, 0.0, 1.0), BoundedShape::kNormal);
  EXPECT_EQ(shape_from_moments(0.2, 0.0, 0.0, 1.0), BoundedShape::kNormal);
  EXPECT_EQ(shape_from_moments(0.5, 1.0 / 12.0, 0.0, 1.0), BoundedShape::kUniform);
  EXPECT_EQ(shape_from_moments(0.2, 1.02 * truncated_exponential_variance(0.2), 0.0, 1.0),
            BoundedShape::kExponentialLike);
  EXPECT_EQ(shape_from_moments(0.149, 0.0411, 0.0, 1.0), BoundedShape::kUShaped);  // an aligned pair of real scans
  EXPECT_EQ(shape_from_moments(0.5, 0.25, 0.0, 1.0), BoundedShape::kUShaped);      // half at each end
}

TEST(ShapeFromMoments, DoesNotDependOnUnitOriginOrDirection) {
  for (const double mean : {0.1, 0.3, 0.45}) {
    for (const double share : {0.2, 0.9, 1.01, 1.5}) {
      const double variance = share * truncated_exponential_variance(mean);
      const BoundedShape shape = shape_from_moments(mean, variance, 0.0, 1.0);
      EXPECT_EQ(shape_from_moments(1.0 - mean, variance, 0.0, 1.0), shape);
      EXPECT_EQ(shape_from_moments(8.0 * mean + 3.0, 64.0 * variance, 3.0, 11.0), shape);
    }
  }
}

TEST(MatchTruncatedMoments, FindsTheParentOfEveryNormalMember) {
  for (const double mean : {1e-6, 1e-3, 0.05, 0.2, 0.4, 0.5, 0.7, 0.99, 0.999999}) {
    for (const double share : {1e-12, 1e-6, 1e-3, 0.1, 0.5, 0.9, 0.99, 0.9999, 1.0 - 1e-6, 1.0 - 1e-8}) {
      const double variance = share * truncated_exponential_variance(mean);
      const auto law = match_truncated_moments(mean, variance, 0.0, 1.0);
      if (!law) {
        EXPECT_EQ(shape_from_moments(mean, variance, 0.0, 1.0), BoundedShape::kUniform) << mean << " " << share;
        continue;
      }
      EXPECT_NEAR(law->mean(), mean, 1e-13) << share;
      EXPECT_NEAR(law->variance(), variance, 1e-10 * variance) << mean << " " << share;
    }
  }
}

TEST(MatchTruncatedMoments, RecoversAParentFromItsTruncatedMoments) {
  for (const TruncatedNormal& parent :
       {TruncatedNormal{-0.7, 0.3, 0.0, 1.0}, {0.1, 0.2, 0.0, 1.0}, {1.4, 0.5, 0.0, 1.0}, {4.0, 2.0, 3.0, 7.0}}) {
    const auto found = match_truncated_moments(parent.mean(), parent.variance(), parent.low, parent.high);
    ASSERT_TRUE(found.has_value());
    EXPECT_NEAR(found->mu, parent.mu, 1e-9);
    EXPECT_NEAR(found->sigma, parent.sigma, 1e-9);
  }
}

TEST(MatchTruncatedMoments, HasNoParentBeyondTheExponential) {
  EXPECT_FALSE(match_truncated_moments(0.2, 0.0, 0.0, 1.0).has_value());
  EXPECT_FALSE(match_truncated_moments(0.149, 0.0411, 0.0, 1.0).has_value());
  EXPECT_FALSE(match_truncated_moments(0.5, 1.0 / 12.0, 0.0, 1.0).has_value());
}

}  // namespace
}  // namespace kilter
