// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/simulation/drift.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace kilter {
namespace {

struct Path {
  std::vector<Pose3> T_world_sensor;
  std::vector<double> path_m;
};

Path straight(double length_m, double step_m) {
  Path path;
  for (double s = 0.0; s <= length_m + 1e-9; s += step_m) {
    path.T_world_sensor.push_back(Pose3::from_translation(s, 0.0, 0.0));
    path.path_m.push_back(s);
  }
  return path;
}

// Error at the end of a path in the true end's frame.
Vector6 end_error(const Path& path, const DriftOptions& options, std::uint64_t stream) {
  Pose3 T = path.T_world_sensor.front();
  for (const Pose3& step : drifting_odometry(path.T_world_sensor, path.path_m, options, Rng(9, stream))) T = T * step;
  return (path.T_world_sensor.back().inverse() * T).log();
}

Vector6 rms_error(const Path& path, const DriftOptions& options, int trials) {
  Vector6 squares = Vector6::Zero();
  for (int i = 0; i < trials; ++i) {
    const Vector6 error = end_error(path, options, static_cast<std::uint64_t>(i));
    squares += error.cwiseProduct(error);
  }
  return (squares / trials).cwiseSqrt();
}

TEST(DriftingOdometry, TranslationErrorGrowsAsStated) {
  DriftOptions options;
  options.bias_rad_per_m.setZero();
  options.jitter_m = 0.0;
  options.jitter_rad = 0.0;
  for (const double length_m : {2.0, 10.0, 80.0}) {
    const double c = options.correlation_m;
    const double growth_m = std::sqrt(2.0 * c * (length_m - c * (1.0 - std::exp(-length_m / c))));
    const Vector6 rms = rms_error(straight(length_m, 0.5), options, 2000);
    for (int axis = 0; axis < 3; ++axis) {
      const double expected_m = options.bias_m_per_m[axis] * growth_m;
      EXPECT_NEAR(rms[axis], expected_m, 0.08 * expected_m) << length_m << " m, axis " << axis;
    }
    EXPECT_LT(rms.tail<3>().norm(), 1e-9);
  }
}

TEST(DriftingOdometry, YawErrorActsThroughItsLever) {
  DriftOptions options;
  options.bias_m_per_m.setZero();
  const Vector6 near = rms_error(straight(10.0, 0.5), options, 500);
  const Vector6 far = rms_error(straight(80.0, 0.5), options, 500);
  EXPECT_LT(near[1], 0.04) << "a submap of 10 m stays nearly rigid";
  EXPECT_GT(far[1], 0.3);
  EXPECT_GT(far[5], 2.0 * near[5]);
}

TEST(DriftingOdometry, TurningAddsYawError) {
  Path spin;
  for (int i = 0; i <= 40; ++i) {
    const Eigen::AngleAxisd turn(0.1 * i, Eigen::Vector3d::UnitZ());
    spin.T_world_sensor.emplace_back(Eigen::Quaterniond(turn), Eigen::Vector3d::Zero());
    spin.path_m.push_back(0.0);
  }
  DriftOptions options;
  options.jitter_rad = 0.0;
  EXPECT_NEAR(rms_error(spin, options, 1000)[5], options.yaw_rad_per_rad * 2.0, 0.1 * options.yaw_rad_per_rad * 2.0);
}

TEST(DriftingOdometry, JitterDoesNotAddUp) {
  DriftOptions options;
  options.bias_m_per_m.setZero();
  options.bias_rad_per_m.setZero();
  options.jitter_rad = 0.0;
  const double expected_m = options.jitter_m * std::numbers::sqrt2;
  for (const double length_m : {5.0, 100.0}) {
    EXPECT_NEAR(rms_error(straight(length_m, 0.5), options, 1000)[0], expected_m, 0.1 * expected_m);
  }
}

TEST(DriftingOdometry, HasOneStepFewerThanPoses) {
  const Path path = straight(3.0, 1.0);
  EXPECT_EQ(drifting_odometry(path.T_world_sensor, path.path_m, {}, Rng(1, 1)).size(), 3U);
  EXPECT_TRUE(drifting_odometry({}, {}, {}, Rng(1, 1)).empty());
}

}  // namespace
}  // namespace kilter
