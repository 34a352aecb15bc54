// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "kilter/geometry/pose3.h"
#include "kilter/occupancy/voxel_map.h"
#include "kilter/submap/ids.h"
#include "kilter/submap/robot_log.h"

namespace kilter {

/// A node of the seed's graph (Eq. 1): a short piece of one robot's journey. All of a submap but its voxels.
struct SubmapNode {
  SubmapId id;
  int robot = 0;                   ///< number of the robot in the mission
  int index = 0;                   ///< 0-based within the robot; the outside counts from 1
  std::string name;                ///< "a/1"
  std::optional<ScanRange> scans;  ///< absent for finished submaps
  Pose3 T_world_submap;            ///< pose of the first scan
  /// Where the sensor was at each scan, in the submap's frame; empty for finished submaps. [m]
  std::vector<Eigen::Vector3d> origins_m;
  double path_start_m = 0.0;       ///< travelled by the robot before this submap
  double path_end_m = 0.0;         ///< travelled by the robot when this submap ended
  std::size_t dropped_points = 0;  ///< NaN, infinite or too far from the submap's frame
};

/// Box around a box that is moved, for what is axis-aligned in one frame and asked for in another; empty if it is. [m]
[[nodiscard]] Eigen::AlignedBox3d moved_box(const Eigen::AlignedBox3d& box_m, const Pose3& T);

/// A node with its piece of the world, as an occupancy map of its own.
struct Submap : SubmapNode {
  VoxelMap map;  ///< in the submap's frame
};

/// What stays of a robot once its submaps are built.
struct RobotSummary {
  std::string name;
  std::size_t scans = 0;       ///< clouds read (finished submaps count as one each)
  double path_length_m = 0.0;  ///< along its cloud poses
  int submaps = 0;
  bool finished_submaps = false;
};

}  // namespace kilter
