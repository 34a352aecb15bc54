// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/bend.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "kilter/base/rng.h"

namespace kilter {
namespace {

// A wall of 20 m along x, seen from both submaps; what lies beyond `from_x` is `apart_m` off, in the sense of the
// source's displacement along +y.
std::vector<PlaneResidual> wall(double from_x, double apart_m, double noise_m) {
  Rng rng(7, 0);
  std::vector<PlaneResidual> residuals;
  for (int i = 0; i < 200; ++i) {
    for (int k = 0; k < 20; ++k) {
      const double x = 0.1 * i;
      const double apart = (x < from_x ? 0.0 : apart_m) + noise_m * rng.normal();
      // The two ways of matching look at the wall from opposite normals.
      const double side = k % 2 == 0 ? 1.0 : -1.0;
      residuals.push_back({{x, 0.05, 0.1 * k}, {0.0, side, 0.0}, side * apart, 1.0});
    }
  }
  return residuals;
}

TEST(MeasureBend, AWallThatIsOneShowsNone) { EXPECT_LT(measure_bend(wall(99.0, 0.0, 0.02), 2.0).rms_m, 0.005); }

TEST(MeasureBend, HalfAWallMovedAwayCountsByItsShare) {
  const Bend bend = measure_bend(wall(10.0, 0.3, 0.01), 2.0);
  EXPECT_NEAR(bend.rms_m, 0.3 * std::sqrt(0.5), 0.02);
  EXPECT_GE(bend.groups, 10);
}

TEST(MeasureBend, ClutterOfAllSizesSaysNothing) {
  Rng rng(8, 0);
  std::vector<PlaneResidual> residuals = wall(99.0, 0.0, 0.01);
  for (PlaneResidual& r : residuals) {
    if (r.point_m.x() > 10.0) r.residual_m = rng.uniform(-1.0, 1.0);
  }
  EXPECT_LT(measure_bend(residuals, 2.0).rms_m, 0.05);
}

TEST(MeasureBend, NothingIsNoBend) {
  EXPECT_EQ(measure_bend({}, 2.0).rms_m, 0.0);
  EXPECT_EQ(measure_bend({}, 2.0).groups, 0);
}

}  // namespace
}  // namespace kilter
