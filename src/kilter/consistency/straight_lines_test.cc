// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// The paper's own example (Sec. IV-B, Fig. 3): straight lines with occupancy 1, aligned or meeting at a point; and what
// the two readings of Eq. (11)-(14) make of textbook distances.
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "kilter/consistency/gamma.h"

namespace kilter {
namespace {

constexpr int kVoxels = 20000;

// Two lines that meet at their start: voxel i of one is as far from the other as it is along it.
std::vector<double> lines_that_open_up_to(double widest_m) {
  std::vector<double> distances(kVoxels);
  for (int i = 0; i < kVoxels; ++i) distances[static_cast<std::size_t>(i)] = widest_m * (i + 0.5) / kVoxels;
  return distances;
}

// Quantiles of |N(0, sd^2)|, by bisection.
std::vector<double> half_normal(double sd) {
  std::vector<double> distances;
  for (int i = 0; i < kVoxels; ++i) {
    double low = 0.0;
    double high = 10.0 * sd;
    for (int halving = 0; halving < 60; ++halving) {
      const double x = 0.5 * (low + high);
      (std::erf(x / sd / std::numbers::sqrt2) * kVoxels < i + 0.5 ? low : high) = x;
    }
    distances.push_back(low);
  }
  return distances;
}

// Gamma of reading A (moments) over Gamma of reading B (likelihood), no floor.
double ratio_of_readings(const std::vector<double>& distances) {
  const GammaOptions literal{.floor = GammaFloor::kNone};
  const auto gamma = [&](DistributionFitMethod method) {
    return score_pair(fit_distribution(distances, {.method = method}).value(), 0.1, literal).gamma_per_m3.value();
  };
  return gamma(DistributionFitMethod::kMoments) / gamma(DistributionFitMethod::kMle);
}

TEST(StraightLines, PerfectAlignmentIsTheDiracLimit) {
  const DistributionFit fit = fit_distribution(std::vector<double>(kVoxels, 0.0)).value();
  EXPECT_EQ(fit.mu_t_m, 0.0);
  EXPECT_EQ(fit.var_t_m2, 0.0);
  EXPECT_FALSE(score_pair(fit, 0.1).gamma_literal_per_m3.has_value());
}

TEST(StraightLines, MisalignmentHasTheUniformsMeanAndVarianceAsParent) {
  const double d = 1.0;
  const DistributionFit fit = fit_distribution(lines_that_open_up_to(d)).value();
  ASSERT_TRUE(fit.parent.has_value());
  EXPECT_NEAR(fit.parent->mu_m, d / 2.0, 1e-14);
  EXPECT_NEAR(fit.parent->sigma_m * fit.parent->sigma_m, d * d / 12.0, 1e-9);
  EXPECT_EQ(fit.shape, BoundedShape::kUniform);
}

TEST(StraightLines, TruncationShrinksTheUniformsVarianceToAnEighteenth) {
  // alpha = -sqrt 3, beta = sqrt 3: Eq. (14) in closed form.
  const double root3 = std::numbers::sqrt3;
  const double density = std::exp(-1.5) / std::sqrt(2.0 * std::numbers::pi);
  const double exact = (1.0 - 2.0 * root3 * density / std::erf(root3 / std::numbers::sqrt2)) / 12.0;
  EXPECT_NEAR(1.0 / exact, 18.1, 0.05);
  const DistributionFit fit = fit_distribution(lines_that_open_up_to(1.0)).value();
  EXPECT_NEAR(fit.mu_t_m, 0.5, 1e-12);
  EXPECT_NEAR(fit.var_t_m2, exact, 1e-9);
}

TEST(StraightLines, WiderOpeningScoresLower) {
  double before = std::numeric_limits<double>::infinity();
  for (const double widest : {0.1, 0.2, 0.4, 0.8, 1.0}) {
    const double gamma = score_pair(fit_distribution(lines_that_open_up_to(widest)).value(), 0.1).gamma_per_m3.value();
    EXPECT_LT(gamma, before);
    before = gamma;
  }
}

TEST(Readings, DifferByTheKnownFactors) {
  EXPECT_NEAR(ratio_of_readings(lines_that_open_up_to(1.0)), 1.507, 5e-4);
  EXPECT_NEAR(ratio_of_readings(lines_that_open_up_to(0.01)), 1.143, 5e-4);
  EXPECT_NEAR(ratio_of_readings(half_normal(0.01)), 1.213, 5e-4);
}

}  // namespace
}  // namespace kilter
