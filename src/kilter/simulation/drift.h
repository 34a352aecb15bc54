// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "kilter/base/rng.h"
#include "kilter/geometry/pose3.h"

namespace kilter {

/// How a lidar front end errs. Each of the six components carries a bias that wanders slowly along the path (so that
/// a submap is nearly rigid and the map as a whole bends), an error for every radian turned, and a small jitter of
/// each scan's own pose that scan matching keeps from adding up.
struct DriftOptions {
  /// Deviation of the wandering bias per metre driven: x (along), y, z. [m/m]
  Eigen::Vector3d bias_m_per_m = {0.003, 0.002, 0.002};
  /// The same for roll, pitch, yaw. [rad/m]
  Eigen::Vector3d bias_rad_per_m = {0.00008, 0.00008, 0.0004};
  double correlation_m = 10.0;     ///< path over which the bias forgets itself
  double yaw_rad_per_rad = 0.003;  ///< deviation of the yaw error per square root of radian turned
  double jitter_m = 0.003;         ///< of each scan, along each axis
  double jitter_rad = 0.0004;      ///< of each scan, about each axis
};

/// Odometry as such a front end reports it: T_previous_this from each pose to the next (one fewer than poses).
/// The error of a chain of L metres has, per translation axis and before rotation errors act through their lever,
/// variance bias^2 * 2c * (L - c (1 - exp(-L/c))) with c = correlation_m: about (bias L)^2 within a submap, growing
/// like a random walk beyond.
///
/// \param T_world_sensor  true poses
/// \param path_m          path driven up to each of them
[[nodiscard]] std::vector<Pose3> drifting_odometry(std::span<const Pose3> T_world_sensor,
                                                   std::span<const double> path_m, const DriftOptions& options,
                                                   Rng rng);

}  // namespace kilter
