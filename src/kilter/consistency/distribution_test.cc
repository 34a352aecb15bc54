// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/consistency/distribution.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include "kilter/base/rng.h"
#include "kilter/numerics/truncated_normal.h"

namespace kilter {
namespace {

constexpr DistributionOptions kMle{.method = DistributionFitMethod::kMle};

// |N(mean, sd)|, drawn again when above d.
std::vector<double> folded_normal(std::size_t count, double mean, double sd, double d, std::uint64_t seed) {
  Rng rng(seed, 0);
  std::vector<double> distances;
  while (distances.size() < count) {
    const double x = std::abs(mean + sd * rng.normal());
    if (x <= d) distances.push_back(x);
  }
  return distances;
}

void expect_same(const DistributionFit& a, const DistributionFit& b, double tolerance) {
  EXPECT_NEAR(a.mu_t_m, b.mu_t_m, tolerance);
  EXPECT_NEAR(a.var_t_m2, b.var_t_m2, tolerance);
  ASSERT_TRUE(a.parent && b.parent);
  EXPECT_NEAR(a.parent->mu_m, b.parent->mu_m, tolerance);
  EXPECT_NEAR(a.parent->sigma_m, b.parent->sigma_m, tolerance);
}

TEST(FitDistribution, MomentsOfTheSampleAreTheParentAndTruncationFollows) {
  const std::vector<double> distances = {0.1, 0.2, 0.3, 0.6};
  const DistributionFit fit = fit_distribution(distances).value();
  EXPECT_EQ(fit.num_matches, 4);
  ASSERT_TRUE(fit.parent.has_value());
  EXPECT_DOUBLE_EQ(fit.parent->mu_m, 0.3);
  EXPECT_DOUBLE_EQ(fit.parent->sigma_m * fit.parent->sigma_m, 0.035);
  const TruncatedNormal law{fit.parent->mu_m, fit.parent->sigma_m, 0.0, 1.0};
  EXPECT_EQ(fit.mu_t_m, law.mean());
  EXPECT_EQ(fit.var_t_m2, law.variance());
  EXPECT_LT(fit.var_t_m2, 0.035);
}

TEST(FitDistribution, LikelihoodKeepsTheSamplesMomentsExactly) {
  const std::vector<double> distances = {0.1, 0.2, 0.3, 0.6};
  const DistributionFit fit = fit_distribution(distances, kMle).value();
  EXPECT_DOUBLE_EQ(fit.mu_t_m, 0.3);
  EXPECT_DOUBLE_EQ(fit.var_t_m2, 0.035);
  ASSERT_TRUE(fit.parent.has_value());
  const TruncatedNormal law{fit.parent->mu_m, fit.parent->sigma_m, 0.0, 1.0};
  EXPECT_NEAR(law.mean(), 0.3, 1e-13);
  EXPECT_NEAR(law.variance(), 0.035, 1e-13);
}

TEST(FitDistribution, NoOtherParentIsMoreLikely) {
  const std::vector<double> distances = folded_normal(500, 0.1, 0.15, 1.0, 3);
  const DistributionFit fit = fit_distribution(distances, kMle).value();
  ASSERT_TRUE(fit.parent.has_value());
  const auto log_likelihood = [&](double mu, double sigma) {
    const TruncatedNormal law{mu, sigma, 0.0, 1.0};
    double sum = 0.0;
    for (const double x : distances) sum += std::log(law.pdf(x));
    return sum;
  };
  const double best = log_likelihood(fit.parent->mu_m, fit.parent->sigma_m);
  for (const double step : {-0.02, 0.02}) {
    EXPECT_GT(best, log_likelihood(fit.parent->mu_m + step, fit.parent->sigma_m));
    EXPECT_GT(best, log_likelihood(fit.parent->mu_m, fit.parent->sigma_m * (1.0 + step)));
  }
}

TEST(FitDistribution, LikelihoodHasNoNormalParentForHeavyTails) {
  std::vector<double> distances = folded_normal(9000, 0.0, 0.05, 1.0, 4);
  for (int i = 0; i < 1000; ++i) distances.push_back((i + 0.5) / 1000.0);  // a tenth of the voxels without partner
  const DistributionFit fit = fit_distribution(distances, kMle).value();
  EXPECT_FALSE(fit.parent.has_value());
  EXPECT_EQ(fit.shape, BoundedShape::kUShaped);
  EXPECT_GT(fit.var_t_m2, 0.02);
  EXPECT_TRUE(fit_distribution(distances).value().parent.has_value());
}

TEST(FitDistribution, OrderOfDistancesOnlyTouchesTheLastBits) {
  std::vector<double> distances = folded_normal(20000, 0.2, 0.1, 1.0, 5);
  const DistributionFit before = fit_distribution(distances).value();
  std::reverse(distances.begin(), distances.end());
  expect_same(fit_distribution(distances).value(), before, 1e-14);
}

TEST(FitDistribution, ScalingAllLengthsScalesTheFit) {
  std::vector<double> distances = folded_normal(2000, 0.3, 0.2, 1.0, 6);
  for (const DistributionFitMethod method : {DistributionFitMethod::kMoments, DistributionFitMethod::kMle}) {
    const DistributionFit small = fit_distribution(distances, {.method = method}).value();
    std::vector<double> scaled = distances;
    for (double& x : scaled) x *= 8.0;
    const DistributionFit large = fit_distribution(scaled, {.max_distance_m = 8.0, .method = method}).value();
    EXPECT_DOUBLE_EQ(large.mu_t_m, 8.0 * small.mu_t_m);
    EXPECT_DOUBLE_EQ(large.var_t_m2, 64.0 * small.var_t_m2);
    ASSERT_TRUE(large.parent && small.parent);
    EXPECT_NEAR(large.parent->mu_m, 8.0 * small.parent->mu_m, 1e-10);
    EXPECT_EQ(large.shape, small.shape);
  }
}

TEST(FitDistribution, EqualDistancesAreTheDiracLimit) {
  for (const double value : {0.0, 0.1, 1.0}) {
    for (const DistributionOptions& options : {DistributionOptions{}, kMle}) {
      const DistributionFit fit = fit_distribution(std::vector<double>(5000, value), options).value();
      EXPECT_EQ(fit.mu_t_m, value);
      EXPECT_EQ(fit.var_t_m2, 0.0);
      ASSERT_TRUE(fit.parent.has_value());
      EXPECT_EQ(fit.parent->mu_m, value);
      EXPECT_EQ(fit.parent->sigma_m, 0.0);
    }
  }
}

TEST(FitDistribution, NearlyEqualDistancesStayFinite) {
  for (const double value : {1e-300, 0.1, 1.0}) {
    std::vector<double> distances(5000, value);
    distances[77] = std::nextafter(value, 0.0);
    for (const DistributionOptions& options : {DistributionOptions{}, kMle}) {
      const DistributionFit fit = fit_distribution(distances, options).value();
      EXPECT_NEAR(fit.mu_t_m, value, 1e-15);
      EXPECT_GE(fit.var_t_m2, 0.0);
      EXPECT_LT(fit.var_t_m2, 1e-30);
    }
  }
}

TEST(FitDistribution, SaturatedDistancesAreFitted) {
  std::vector<double> distances = folded_normal(2000, 0.95, 0.2, 1.0, 7);
  distances.insert(distances.end(), 500, 1.0);
  for (const DistributionOptions& options : {DistributionOptions{}, kMle}) {
    const DistributionFit fit = fit_distribution(distances, options).value();
    EXPECT_GT(fit.mu_t_m, 0.7);
    EXPECT_LT(fit.mu_t_m, 1.0);
    EXPECT_GT(fit.var_t_m2, 0.0);
  }
}

TEST(FitDistribution, RefusesTooFewOrForeignDistancesAndBadOptions) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const std::vector<double>& bad :
       {std::vector<double>{}, {0.5}, {0.1, 1.5}, {0.1, -0.1}, {0.1, nan}, {0.1, 1.0 / 0.0}}) {
    const auto fit = fit_distribution(bad);
    ASSERT_FALSE(fit.has_value());
    EXPECT_EQ(fit.error().code, ErrorCode::kInvalidArgument);
  }
  for (const double d : {0.0, -1.0, nan, std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(fit_distribution(std::vector<double>{0.0, 0.0}, {.max_distance_m = d}).has_value());
  }
}

TEST(HistogramDistances, CountsEveryDistanceOnceWithTheLastBinClosed) {
  const std::vector<double> distances = {0.0, 0.004, 0.01, 0.995, 1.0, 0.5};
  const DistanceHistogram histogram = histogram_distances(distances).value();
  ASSERT_EQ(histogram.counts.size(), 100U);
  EXPECT_EQ(histogram.counts[0], 2);
  EXPECT_EQ(histogram.counts[1], 1);
  EXPECT_EQ(histogram.counts[99], 2);
  EXPECT_EQ(std::accumulate(histogram.counts.begin(), histogram.counts.end(), std::int64_t{0}), 6);
}

TEST(HistogramDistances, CutsTheLastBinShortWhenTheWidthDoesNotDivide) {
  const auto bins = [](double d, double width) {
    return histogram_distances({}, {.max_distance_m = d, .histogram_width_m = width}).value().counts.size();
  };
  EXPECT_EQ(bins(1.0, 0.3), 4U);
  EXPECT_EQ(bins(0.3, 0.1), 3U);  // 0.3 / 0.1 is not 3 in binary
  EXPECT_EQ(bins(0.7, 0.01), 70U);
  EXPECT_EQ(bins(0.1, 5.0), 1U);
}

TEST(HistogramDistances, RefusesWidthsThatMakeNoHistogram) {
  const std::vector<double> distances = {0.1, 0.2};
  for (const double width : {0.0, -0.1, 1e-9, std::numeric_limits<double>::quiet_NaN()}) {
    const auto histogram = histogram_distances(distances, {.histogram_width_m = width});
    ASSERT_FALSE(histogram.has_value());
    EXPECT_EQ(histogram.error().code, ErrorCode::kInvalidArgument);
  }
  EXPECT_FALSE(histogram_distances(std::vector<double>{2.0}).has_value());
}

TEST(DistributionOptions, AreReadThroughTheirFields) {
  DistributionOptions options;
  const std::vector<OptionField> table = fields(options);
  ASSERT_EQ(table.size(), 3U);
  EXPECT_EQ(table[0].name, "d");
  EXPECT_TRUE(table[0].assign("50 cm").has_value());
  EXPECT_TRUE(table[1].assign("0.02").has_value());
  EXPECT_TRUE(table[2].assign("mle").has_value());
  EXPECT_DOUBLE_EQ(options.max_distance_m, 0.5);
  EXPECT_DOUBLE_EQ(options.histogram_width_m, 0.02);
  EXPECT_EQ(options.method, DistributionFitMethod::kMle);
  EXPECT_FALSE(table[0].assign("0").has_value());
}

}  // namespace
}  // namespace kilter
