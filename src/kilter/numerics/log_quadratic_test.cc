// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/numerics/log_quadratic.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

namespace kilter {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(LogQuadratic, FlatWeightHasTheMomentsOfTheUniform) {
  const LogQuadraticMoments m = LogQuadratic{0.0, 0.0, 0.0, 3.0}.moments();
  EXPECT_NEAR(m.mass(), 3.0, 1e-14);
  EXPECT_NEAR(m.mean(), 1.5, 1e-14);
  EXPECT_NEAR(m.variance(), 0.75, 1e-14);
  EXPECT_NEAR(m.unit_third, 0.0, 1e-16);
  EXPECT_NEAR(m.unit_fourth, 1.0 / 80.0, 1e-16);
}

TEST(LogQuadratic, ZeroCurvatureIsTheExponential) {
  for (const double slope : {1e-3, 1.0, 1e6}) {
    const LogQuadraticMoments m = LogQuadratic{slope, 0.0, 0.0, kInfinity}.moments();
    EXPECT_NEAR(m.mass() * slope, 1.0, 2e-15);
    EXPECT_NEAR(m.mean() * slope, 1.0, 2e-15);
    EXPECT_NEAR(m.variance() * slope * slope, 1.0, 4e-15);
    const double cube = m.length * m.length * m.length * slope * slope * slope;
    EXPECT_NEAR(m.unit_third * cube, 2.0, 1e-13);
    EXPECT_NEAR(m.unit_fourth * cube * m.length * slope, 9.0, 1e-12);
  }
}

TEST(LogQuadratic, ZeroSlopeIsTheNormal) {
  const LogQuadraticMoments m = LogQuadratic{0.0, 4.0, -kInfinity, kInfinity}.moments();
  EXPECT_NEAR(m.mass(), std::sqrt(0.5 * std::numbers::pi), 2e-15);
  EXPECT_NEAR(m.mean(), 0.0, 4e-15);
  EXPECT_NEAR(m.variance(), 0.25, 1e-15);
  const double fourth = std::pow(m.length, 4) * m.unit_fourth;
  EXPECT_NEAR(fourth, 3.0 / 16.0, 1e-14);
}

TEST(LogQuadratic, NegativeCurvatureAgreesWithAFineSum) {
  const LogQuadratic weight{5.0, -5.0, 0.0, 1.0};
  constexpr int kSteps = 200000;
  double mass = 0.0;
  double first = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double v = (i + 0.5) / kSteps;
    const double w = std::exp(-5.0 * v + 2.5 * v * v) / kSteps;
    mass += w;
    first += w * v;
  }
  EXPECT_NEAR(weight.moments().mass(), mass, 1e-10);
  EXPECT_NEAR(weight.moments().mean(), first / mass, 1e-10);
}

TEST(LogQuadratic, NeitherOverflowsNorUnderflowsAtTheEndsOfDouble) {
  const LogQuadraticMoments steep = LogQuadratic{1e200, 1.0, 0.0, 1e300}.moments();
  EXPECT_NEAR(steep.mean() * 1e200, 1.0, 1e-13);
  const LogQuadraticMoments sliver = LogQuadratic{0.0, 1.0, 0.0, 1e-200}.moments();
  EXPECT_NEAR(sliver.unit_variance, 1.0 / 12.0, 1e-15);
}

}  // namespace
}  // namespace kilter
