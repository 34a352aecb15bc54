// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "kilter/geometry/pose3.h"
#include "kilter/submap/robot_log.h"
#include "kilter/submap/submap.h"

namespace kilter::testing {

/// An axis-aligned solid box in the world.
struct Box {
  Eigen::Vector3d low_m;
  Eigen::Vector3d high_m;
};

/// Solid boxes only; rays that meet none come back without a return.
using Scene = std::vector<Box>;

/// A 12 m x 8 m x 3 m room with cupboards, a pillar and a table: every direction is fixed.
[[nodiscard]] Scene furnished_room();

/// Two bare walls, floor and ceiling, 80 m long in x: nothing fixes x.
[[nodiscard]] Scene bare_corridor();

/// One turn of a lidar with `beams` rings over +-25 degrees and `columns` azimuths, in the sensor's frame.
[[nodiscard]] std::vector<Eigen::Vector3d> scan(const Scene& scene, const Pose3& T_world_sensor, double noise_m,
                                                std::uint64_t seed, int beams = 24, int columns = 300);

/// A submap made of one scan at each true pose, placed at `T_world_submap_believed` (the map's opinion).
[[nodiscard]] Submap submap_of(const Scene& scene, const std::vector<Pose3>& T_world_sensor,
                               const Pose3& T_world_submap_believed, std::uint64_t seed, double noise_m = 0.01);

/// A robot whose scans are taken at `truth` and whose log says `believed`.
[[nodiscard]] RobotLog robot_log(std::string name, const Scene& scene, const std::vector<Pose3>& truth,
                                 const std::vector<Pose3>& believed, std::uint64_t seed, double noise_m = 0.01);

/// Poses along a straight line, `step_m` apart, looking along it.
[[nodiscard]] std::vector<Pose3> straight_path(const Eigen::Vector3d& from_m, const Eigen::Vector3d& direction,
                                               int count, double step_m);

/// An upright pose. [m], [rad]
[[nodiscard]] Pose3 pose_at(double x, double y, double z, double yaw);

/// Two submaps of one scene from different places, and the pose that brings the source onto the target.
struct SubmapPair {
  Submap target;
  Submap source;
  Pose3 T_target_source;
};

/// The furnished room seen from two ends: they overlap widely, and one pose alone fits.
[[nodiscard]] SubmapPair room_pair();

}  // namespace kilter::testing
