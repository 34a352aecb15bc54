// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/bend.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "kilter/base/rng.h"

namespace kilter {
namespace {

constexpr double kVoxel_m = 0.1;
const PairGrain kGrain = {.edge_m = kVoxel_m};
constexpr double kReach_m = 1.0;

// How far the source lies off along +x and +y at a place, for what it saw at a time (0..255).
using Displacement = std::function<Eigen::Vector2d(const Eigen::Vector3d& at_m, std::uint8_t source_at)>;

// A hall of 24 by 10 m with walls on all sides and a floor; either submap saw every place at all times.
std::vector<PlaneResidual> hall(const Displacement& displacement, double noise_m) {
  Rng rng(7, 0);
  std::vector<PlaneResidual> residuals;
  const auto add = [&](const Eigen::Vector3d& at_m, const Eigen::Vector3d& normal) {
    const auto source_at = static_cast<std::uint8_t>(rng.uniform(0.0, 255.9));
    const auto target_at = static_cast<std::uint8_t>(rng.uniform(0.0, 255.9));
    const Eigen::Vector2d moved_m = displacement(at_m, source_at);
    const double off_m = normal.head<2>().dot(moved_m) + noise_m * rng.normal();
    residuals.push_back({at_m, normal, off_m, 1.0, source_at, target_at});
  };
  for (int i = 0; i < 2400; ++i) {
    const double along_m = rng.uniform(0.0, 24.0);
    const double across_m = rng.uniform(0.0, 10.0);
    const double up_m = rng.uniform(0.0, 3.0);
    const double side = i % 2 == 0 ? 1.0 : -1.0;
    add({along_m, side > 0.0 ? 0.0 : 10.0, up_m}, {0.0, side, 0.0});
    add({side > 0.0 ? 0.0 : 24.0, across_m, up_m}, {side, 0.0, 0.0});
    add({along_m, across_m, 0.0}, {0.0, 0.0, 1.0});
  }
  return residuals;
}

Bend bend_of(const Displacement& displacement, double noise_m = 0.01) {
  return measure_bend(hall(displacement, noise_m), kGrain, kReach_m);
}

TEST(MeasureBend, AHallThatIsOneShowsNone) {
  EXPECT_LT(bend_of([](const auto&, auto) { return Eigen::Vector2d(0.0, 0.0); }, 0.02).rms_m, 0.005);
}

TEST(MeasureBend, AFarEndThatWasMovedCountsByItsShare) {
  const Bend bend =
      bend_of([](const Eigen::Vector3d& at_m, auto) { return Eigen::Vector2d(0.0, at_m.x() < 12.0 ? 0.0 : 0.3); });
  EXPECT_NEAR(bend.rms_m, 0.3 * std::sqrt(0.5), 0.03);
  EXPECT_EQ(bend.kind, BendKind::kSpace);
  EXPECT_GT(bend.variance_m4, 0.0);
}

TEST(MeasureBend, ASlipInsideTheSourceIsFoundByTimeAndNamed) {
  const Bend bend = bend_of([](const auto&, std::uint8_t source_at) {
    return source_at < 192 ? Eigen::Vector2d(0.0, 0.0) : Eigen::Vector2d(0.2, 0.2);
  });
  EXPECT_NEAR(bend.rms_m, std::sqrt(0.08 * 0.25), 0.03);
  EXPECT_EQ(bend.kind, BendKind::kSource);
}

TEST(MeasureBend, ClutterOfAllSizesSaysNothing) {
  Rng rng(8, 0);
  std::vector<PlaneResidual> residuals = hall([](const auto&, auto) { return Eigen::Vector2d(0.0, 0.0); }, 0.01);
  for (PlaneResidual& r : residuals) {
    if (r.point_m.x() > 12.0) r.residual_m = rng.uniform(-1.0, 1.0);
  }
  EXPECT_LT(measure_bend(residuals, kGrain, kReach_m).rms_m, 0.02);
}

// Beyond the middle the two saw different surfaces: some fit where they are, twice as many happen to fit 0.3 m off.
TEST(MeasureBend, AMotionThatMakesLittleMoreFitIsHalfBelievedAndDoubted) {
  Rng rng(9, 0);
  std::vector<PlaneResidual> residuals = hall([](const auto&, auto) { return Eigen::Vector2d(0.0, 0.0); }, 0.01);
  for (PlaneResidual& r : residuals) {
    if (r.point_m.x() < 12.0 || r.direction.y() == 0.0) continue;
    r.residual_m = (rng.uniform(0.0, 1.0) < 2.0 / 3.0 ? 0.3 * r.direction.y() : 0.0) + 0.01 * rng.normal();
  }
  const Bend bend = measure_bend(residuals, kGrain, kReach_m);
  const double certain_m = 0.3 * std::sqrt(0.5);
  EXPECT_NEAR(bend.rms_m, certain_m * std::sqrt(0.5), 0.05);
  EXPECT_GT(std::sqrt(bend.variance_m4), 0.5 * bend.rms_m * bend.rms_m);
}

TEST(MeasureBend, NothingIsNoBend) {
  EXPECT_EQ(measure_bend({}, kGrain, kReach_m).rms_m, 0.0);
  EXPECT_EQ(measure_bend({}, kGrain, kReach_m).parts, 0);
}

}  // namespace
}  // namespace kilter
