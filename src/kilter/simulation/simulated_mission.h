// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/base/parallel.h"
#include "kilter/simulation/lidar.h"
#include "kilter/simulation/ray_caster.h"
#include "kilter/simulation/scene.h"
#include "kilter/simulation/slam.h"

namespace kilter {

/// One robot's session: what is true and what its map says.
struct SimulatedRobot {
  std::string name;                        ///< "a", "b", ...
  std::vector<double> stamp_s;             ///< of each scan
  std::vector<Pose3> T_world_sensor_true;  ///< of each scan
  std::vector<Pose3> T_world_sensor;       ///< as estimated: what `poses.tum` holds
};

/// A mission before its scans are made: everything about it but the points. Scans are made one by one, in any order,
/// so that memory does not grow with the mission's length.
class SimulatedMission {
 public:
  /// Drives the scene's routes and estimates the map, with the faults that the scene asks for.
  /// \return what `run_slam` and `RayCaster::build` return.
  [[nodiscard]] static Expected<SimulatedMission> plan(Scene scene, const LidarModel& lidar, std::uint64_t seed);

  [[nodiscard]] const std::vector<SimulatedRobot>& robots() const { return robots_; }
  [[nodiscard]] const std::vector<Fault>& faults() const { return faults_; }
  [[nodiscard]] std::size_t scan_count() const;

  /// Scan `i` of robot `r`. Depends on nothing but the mission, r and i; safe from several threads at once.
  [[nodiscard]] SimulatedScan scan(std::size_t r, std::size_t i) const;

 private:
  SimulatedMission(RayCaster world, const LidarModel& lidar, std::uint64_t seed)
      : world_(std::move(world)), lidar_(lidar), seed_(seed) {}

  RayCaster world_;
  LidarModel lidar_;
  std::uint64_t seed_;
  std::vector<Trajectory> trajectories_;
  std::vector<double> start_s_;
  std::vector<SimulatedRobot> robots_;
  std::vector<Fault> faults_;
};

/// Makes all scans of a robot in blocks on `run.threads` threads and hands them over in order.
/// `take(i, scan)` may fail, which ends the work. \return its error, or kCancelled.
[[nodiscard]] Expected<void> for_each_scan(
    const SimulatedMission& mission, std::size_t r, const RunContext& run,
    const std::function<Expected<void>(std::size_t i, const SimulatedScan& scan)>& take);

}  // namespace kilter
