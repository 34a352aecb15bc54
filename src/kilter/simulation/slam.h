// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/simulation/drift.h"
#include "kilter/simulation/fault.h"

namespace kilter {

/// Where one robot truly was.
struct RobotMotion {
  std::string name;
  std::vector<Pose3> T_world_sensor;  ///< of each scan; at least 2
  std::vector<double> path_m;         ///< driven up to each scan
};

/// How the simulated front and back end behave.
struct SlamOptions {
  DriftOptions drift = {};
  double closure_distance_m = 1.5;  ///< places nearer than this are recognised
  double closure_gap_m = 12.0;      ///< by the same robot only after this much path
  double closure_spacing_m = 2.0;   ///< path between two closures
  double closure_sigma_m = 0.01;    ///< error of a closure, along each axis
  double closure_sigma_rad = 0.001;
  bool within_robots = true;   ///< look for closures of a robot with itself
  bool between_robots = true;  ///< and with the others
};

/// What the mission's map is drawn with, and what is wrong with it.
struct SlamResult {
  std::vector<std::vector<Pose3>> T_world_sensor;  ///< per robot, per scan
  std::vector<Fault> faults;                       ///< in the order of the requests
};

/// Estimates the robots' poses as a SLAM system would: drifting odometry, closures where the robots truly meet,
/// relaxed together. The first pose of the first robot is true; the others' start is known to a closure's accuracy.
///
/// Faults enter as events: a slip changes one odometry step; drift of a missed closure is spread over its stretch, and
/// in up to twelve tries pushed towards the asked size in the finished estimate, which may still fall short or exceed
/// it where other closures hold the robot; a wrong closure or mistaken place is one more edge. The result's faults say
/// what size came out.
/// Closures that contradict an event are left out, as robust back ends reject them; all others stay.
///
/// \return kInvalidArgument for a fault that the mission has no room for (a robot that does not exist, that never
///         comes back, never meets another) or a graph that does not settle; its message names the faults.
[[nodiscard]] Expected<SlamResult> run_slam(std::span<const RobotMotion> truth, std::span<const FaultRequest> requests,
                                            const SlamOptions& options, std::uint64_t seed);

/// How far an estimated relative pose is from the true one, in the frame of `b`: the twist of
/// (T_a_b true)^-1 * (T_a_b estimated).
[[nodiscard]] Vector6 relative_error(const Pose3& true_a, const Pose3& true_b, const Pose3& estimated_a,
                                     const Pose3& estimated_b);

}  // namespace kilter
