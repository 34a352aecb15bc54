// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/consistency/gamma.h"

#include <cmath>

#include <gtest/gtest.h>

#include "kilter/base/rng.h"

namespace kilter {
namespace {

constexpr GammaOptions kNoFloor{.floor = GammaFloor::kNone};

DistributionFit fit_of(double mu_t_m, double var_t_m2) {
  DistributionFit fit;
  fit.mu_t_m = mu_t_m;
  fit.var_t_m2 = var_t_m2;
  fit.num_matches = 500;
  return fit;
}

TEST(ScorePair, IsTheInverseOfMeanTimesVariance) {
  const PairScore score = score_pair(fit_of(0.2, 0.01), 0.1);
  EXPECT_DOUBLE_EQ(score.gamma_literal_per_m3.value(), 500.0);
  EXPECT_DOUBLE_EQ(score.gamma_per_m3.value(), 500.0);
  EXPECT_DOUBLE_EQ(score.log10_gamma.value(), std::log10(500.0));
  EXPECT_DOUBLE_EQ(score.gamma_dimensionless.value(), 500.0 * 0.001 / 75.0);
  EXPECT_EQ(score.fit.num_matches, 500);
}

TEST(ScorePair, FloorsWhatTheGridCannotResolve) {
  const PairScore score = score_pair(fit_of(0.001, 1e-8), 0.1);
  EXPECT_DOUBLE_EQ(score.mu_floored_m, 0.025);
  EXPECT_DOUBLE_EQ(score.var_floored_m2, 0.015 * 0.015);
  EXPECT_DOUBLE_EQ(score.gamma_per_m3.value(), 1.0 / (0.025 * 0.015 * 0.015));
  EXPECT_DOUBLE_EQ(score.gamma_literal_per_m3.value(), 1e11);
}

TEST(ScorePair, WithoutFloorIsLiteral) {
  for (const double mu : {0.001, 0.02, 0.5}) {
    const PairScore score = score_pair(fit_of(mu, 1e-5), 0.1, kNoFloor);
    EXPECT_EQ(score.gamma_per_m3, score.gamma_literal_per_m3);
  }
}

TEST(ScorePair, InfiniteGammaIsAbsent) {
  for (const DistributionFit& fit : {fit_of(0.0, 0.0), fit_of(0.1, 0.0), fit_of(1e-200, 1e-200)}) {
    const PairScore literal = score_pair(fit, 0.1, kNoFloor);
    EXPECT_FALSE(literal.gamma_per_m3.has_value());
    EXPECT_FALSE(literal.log10_gamma.has_value());
    EXPECT_FALSE(literal.gamma_dimensionless.has_value());
    const PairScore floored = score_pair(fit, 0.1);
    EXPECT_FALSE(floored.gamma_literal_per_m3.has_value());
    EXPECT_TRUE(std::isfinite(floored.gamma_per_m3.value()));
  }
}

TEST(ScorePair, ScalingAllLengthsDividesGammaByTheCube) {
  const PairScore small = score_pair(fit_of(0.01, 0.002), 0.1);
  const PairScore large = score_pair(fit_of(0.02, 0.008), 0.2);
  EXPECT_DOUBLE_EQ(large.gamma_per_m3.value(), small.gamma_per_m3.value() / 8.0);
  EXPECT_DOUBLE_EQ(large.gamma_literal_per_m3.value(), small.gamma_literal_per_m3.value() / 8.0);
  EXPECT_DOUBLE_EQ(large.gamma_dimensionless.value(), small.gamma_dimensionless.value());
}

// Two griddings of one plane, the second shifted along the normal: the tangential part is what the grid leaves over.
double gamma_of_shifted_plane(double offset_m, const GammaOptions& options) {
  Rng rng(1, 0);
  std::vector<double> distances(20000);
  for (double& x : distances) x = std::hypot(offset_m, rng.uniform(-0.05, 0.05), rng.uniform(-0.05, 0.05));
  return score_pair(fit_distribution(distances).value(), 0.1, options).gamma_per_m3.value();
}

TEST(ScorePair, LiteralGammaRewardsAParallelOffsetAndTheFloorDoesNot) {
  const double offsets[] = {0.0, 0.05, 0.1, 0.2};
  for (std::size_t i = 1; i < std::size(offsets); ++i) {
    EXPECT_GT(gamma_of_shifted_plane(offsets[i], kNoFloor), gamma_of_shifted_plane(offsets[i - 1], kNoFloor));
    EXPECT_LT(gamma_of_shifted_plane(offsets[i], {}), gamma_of_shifted_plane(offsets[i - 1], {}));
  }
}

TEST(GammaOptions, AreReadThroughTheirFields) {
  GammaOptions options;
  const std::vector<OptionField> table = fields(options);
  ASSERT_EQ(table.size(), 1U);
  EXPECT_EQ(table[0].name, "floor");
  EXPECT_EQ(table[0].text(), "quantisation");
  EXPECT_TRUE(table[0].assign("none").has_value());
  EXPECT_EQ(options.floor, GammaFloor::kNone);
}

}  // namespace
}  // namespace kilter
