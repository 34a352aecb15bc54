// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/numerics/truncated_normal.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "kilter/base/rng.h"
#include "kilter/numerics/certified_table.h"
#include "kilter/numerics/special.h"

namespace kilter {
namespace {

double relative_error(double found, double expected) {
  return expected == 0.0 ? std::abs(found) : std::abs(found / expected - 1.0);
}

std::string as_text(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", x);
  return text;
}

TEST(TruncatedNormal, MomentsMatchTheCertifiedTable) {
  const auto rows = load_certified("truncated_normal.csv");
  ASSERT_GE(rows.size(), 200U);
  double worst_mean = 0.0;
  double worst_variance = 0.0;
  for (const auto& row : rows) {
    const TruncatedNormal law{number_of(row[0]), number_of(row[1]), number_of(row[2]), number_of(row[3])};
    const double mean = number_of(row[5]);
    // A mean near 0 of an interval around 0 has no relative error to speak of.
    const double scale = law.low < 0.0 ? law.high - law.low : std::abs(mean);
    const double mean_error = std::abs(law.mean() - mean) / scale;
    const double variance_error = relative_error(law.variance(), number_of(row[6]));
    EXPECT_LE(mean_error, 1e-14) << row[0] << " " << row[1] << " " << row[3];
    EXPECT_LE(variance_error, 1e-14) << row[0] << " " << row[1] << " " << row[3];
    worst_mean = std::max(worst_mean, mean_error);
    worst_variance = std::max(worst_variance, variance_error);
  }
  RecordProperty("worst_mean_error", as_text(worst_mean));
  RecordProperty("worst_variance_error", as_text(worst_variance));
}

TEST(TruncatedNormal, DensityAndDistributionMatchTheCertifiedTable) {
  for (const auto& row : load_certified("truncated_normal.csv")) {
    const TruncatedNormal law{number_of(row[0]), number_of(row[1]), number_of(row[2]), number_of(row[3])};
    const double x = number_of(row[4]);
    // exp(-e) keeps e fewer ulp; below the range of double there is nothing to compare.
    const double z = (x - law.mu) / law.sigma;
    const double z_peak = (std::clamp(law.mu, law.low, law.high) - law.mu) / law.sigma;
    const double tolerance = 1e-14 + 1e-15 * 0.5 * std::abs(z * z - z_peak * z_peak);
    for (const auto& [found, cell] : {std::pair{law.pdf(x), row[7]}, std::pair{law.cdf(x), row[8]}}) {
      const double expected = number_of(cell);
      EXPECT_NEAR(found, expected, std::max(tolerance * expected, std::numeric_limits<double>::min()))
          << row[0] << " " << row[1] << " " << row[3] << " at " << x;
    }
  }
}

TEST(TruncatedNormal, VarianceStaysPositiveWhereThePrintedFormIsNegative) {
  const TruncatedNormal law{-0.7, 0.09, 0.0, 1.0};
  EXPECT_GT(law.variance(), 0.0);
  EXPECT_LT(law.variance(), law.sigma * law.sigma);
  EXPECT_GT(law.mean(), 0.0);
}

TEST(TruncatedNormal, MirroringMirrorsTheMean) {
  Rng rng(5, 0);
  for (int i = 0; i < 2000; ++i) {
    const TruncatedNormal law{rng.uniform(-40.0, 40.0), std::exp(rng.uniform(-7.0, 7.0)), 0.0,
                              std::exp(rng.uniform(-7.0, 7.0))};
    const TruncatedNormal mirrored{-law.mu, law.sigma, -law.high, -law.low};
    EXPECT_NEAR(mirrored.mean(), -law.mean(), 1e-14 * (law.high - law.low));
    EXPECT_NEAR(mirrored.variance(), law.variance(), 1e-14 * law.variance());
    const double x = law.mean();
    EXPECT_NEAR(mirrored.cdf(-x), 1.0 - law.cdf(x), 1e-14);
  }
}

TEST(TruncatedNormal, ScalingAllLengthsScalesTheMoments) {
  const TruncatedNormal law{0.31, 0.17, 0.0, 1.0};
  const TruncatedNormal scaled{0.31 * 1024, 0.17 * 1024, 0.0, 1024.0};
  EXPECT_EQ(scaled.mean(), 1024 * law.mean());
  EXPECT_EQ(scaled.variance(), 1024.0 * 1024.0 * law.variance());
}

TEST(TruncatedNormal, TailMassAgreesWithItsClosedForm) {
  // Z / phi(alpha) from scaled tails: an independent way to the normaliser of Eq. (12).
  for (const double alpha : {0.0, 0.5, 3.0, 12.0, 40.0}) {
    const double beta = alpha + 2.0;
    const double scaled_tails = erfcx(alpha / std::numbers::sqrt2) -
                                std::exp(-0.5 * (beta * beta - alpha * alpha)) * erfcx(beta / std::numbers::sqrt2);
    const double expected = 1.0 / (std::sqrt(0.5 * std::numbers::pi) * scaled_tails);
    EXPECT_NEAR(TruncatedNormal({-alpha, 1.0, 0.0, 2.0}).pdf(0.0), expected, 1e-14 * expected) << alpha;
  }
}

TEST(TruncatedNormal, DistributionClimbsFromZeroToOne) {
  for (const double mu : {-5.0, 0.4, 6.0}) {
    const TruncatedNormal law{mu, 0.5, 0.0, 1.0};
    EXPECT_EQ(law.cdf(-0.1), 0.0);
    EXPECT_EQ(law.cdf(0.0), 0.0);
    EXPECT_EQ(law.cdf(1.0), 1.0);
    EXPECT_EQ(law.pdf(-1e-9), 0.0);
    EXPECT_EQ(law.pdf(1.0 + 1e-9), 0.0);
    double before = 0.0;
    for (int i = 1; i <= 100; ++i) {
      const double now = law.cdf(i * 0.01);
      EXPECT_GT(now, before);
      before = now;
    }
  }
}

TEST(TruncatedNormal, LimitsAreUniformAndDirac) {
  const TruncatedNormal wide{0.2, 1e150, 0.0, 1.0};
  EXPECT_NEAR(wide.mean(), 0.5, 1e-15);
  EXPECT_NEAR(wide.variance(), 1.0 / 12.0, 1e-15);
  const TruncatedNormal needle{0.3, 1e-150, 0.0, 1.0};
  EXPECT_EQ(needle.mean(), 0.3);
  EXPECT_NEAR(needle.variance() / 1e-300, 1.0, 1e-14);
}

}  // namespace
}  // namespace kilter
