// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "kilter/geometry/pose3.h"

namespace kilter {

/// How a robot drives along its corners.
struct RouteOptions {
  double speed_mps = 0.8;
  double turn_rate_radps = 0.8;  ///< turning on the spot
  double corner_radius_m = 0.7;  ///< corners are rounded, as far as their legs allow
  double sensor_height_m = 0.7;  ///< of the lidar above the ground
  double sway_rad = 0.005;       ///< roll and pitch of the body on uneven ground, standard deviation
  double heave_m = 0.004;        ///< the same for its height
  std::uint64_t seed = 1;        ///< of sway and heave
};

/// The true motion of a robot's lidar: smooth, defined at any time (the ends stand still).
class Trajectory {
 public:
  /// Drives through the corners (points on the ground, world frame), rounding them; corners sharper than 150 degrees
  /// become a stop and a turn on the spot. At least 2 distinct corners.
  [[nodiscard]] static Trajectory along(const std::vector<Eigen::Vector3d>& corners_m, const RouteOptions& options);

  /// T_world_sensor: x ahead, z up.
  [[nodiscard]] Pose3 at(double time_s) const;

  [[nodiscard]] double duration_s() const { return knots_.back().time_s; }
  [[nodiscard]] double length_m() const { return knots_.back().path_m; }

  /// Path driven until a time. [m]
  [[nodiscard]] double path_m(double time_s) const;

  /// Times of key scans: the start, and whenever the robot has driven `step_m` or turned `step_rad` since the last.
  [[nodiscard]] std::vector<double> scan_times_s(double step_m, double step_rad) const;

 private:
  // Where the robot's base is; linear in between.
  struct Knot {
    double time_s = 0.0;
    double path_m = 0.0;
    double yaw_rad = 0.0;    // unwrapped
    double pitch_rad = 0.0;  // nose down is positive
    Eigen::Vector3d ground_m = Eigen::Vector3d::Zero();
  };
  // One sine of the body's sway.
  struct Wave {
    double amplitude = 0.0;
    double rate_radps = 0.0;
    double phase_rad = 0.0;
  };

  void drive_to(const Eigen::Vector3d& ground_m);
  void turn_to(double yaw_rad);
  void round_corner(const Eigen::Vector3d& before_m, const Eigen::Vector3d& corner_m, const Eigen::Vector3d& after_m);
  void smooth_pitch();
  [[nodiscard]] Knot interpolate(double time_s) const;

  RouteOptions options_;
  std::vector<Knot> knots_;
  std::vector<Wave> roll_, pitch_, heave_;
};

}  // namespace kilter
