// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/simulation/drift.h"

#include <cmath>

#include "kilter/base/contract.h"

namespace kilter {
namespace {

Vector6 six_normals(Rng& rng) {
  Vector6 values;
  for (int i = 0; i < 6; ++i) values[i] = rng.normal();
  return values;
}

Pose3 scan_jitter(const DriftOptions& options, Rng& rng) {
  Vector6 xi = six_normals(rng);
  xi.head<3>() *= options.jitter_m;
  xi.tail<3>() *= options.jitter_rad;
  return Pose3::exp(xi);
}

// An Ornstein-Uhlenbeck process along the path: stationary, deviation 1, correlation exp(-distance / correlation_m).
void wander(Vector6& state, double distance_m, double correlation_m, Rng& rng) {
  const double kept = std::exp(-distance_m / correlation_m);
  state = kept * state + std::sqrt(1.0 - kept * kept) * six_normals(rng);
}

}  // namespace

std::vector<Pose3> drifting_odometry(std::span<const Pose3> T_world_sensor, std::span<const double> path_m,
                                     const DriftOptions& options, Rng rng) {
  KILTER_EXPECTS(T_world_sensor.size() == path_m.size());
  std::vector<Pose3> odometry;
  Vector6 bias = six_normals(rng);
  Pose3 jitter_before = scan_jitter(options, rng);
  for (std::size_t i = 1; i < T_world_sensor.size(); ++i) {
    const Pose3 T_before_this = T_world_sensor[i - 1].inverse() * T_world_sensor[i];
    const double driven_m = path_m[i] - path_m[i - 1];
    wander(bias, driven_m, options.correlation_m, rng);
    Vector6 error;
    error.head<3>() = driven_m * options.bias_m_per_m.cwiseProduct(bias.head<3>());
    error.tail<3>() = driven_m * options.bias_rad_per_m.cwiseProduct(bias.tail<3>());
    error[5] += options.yaw_rad_per_rad * std::sqrt(T_before_this.angle_rad()) * rng.normal();
    const Pose3 jitter = scan_jitter(options, rng);
    odometry.push_back(jitter_before.inverse() * T_before_this * Pose3::exp(error) * jitter);
    jitter_before = jitter;
  }
  return odometry;
}

}  // namespace kilter
