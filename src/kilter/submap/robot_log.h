// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/geometry/point_cloud.h"
#include "kilter/geometry/pose3.h"
#include "kilter/occupancy/occupancy_cells.h"

namespace kilter {

/// What can be told of a cloud without reading its points.
struct CloudPeek {
  std::optional<std::uint64_t> points;  ///< as its header promises, NaN included
  std::uint64_t bytes = 0;              ///< on disk
  std::uint64_t head = 0;               ///< a digest of its first bytes: equal clouds have equal ones
  bool is_cut_short = false;            ///< no header where one must be, or fewer bytes than it promises

  bool operator==(const CloudPeek&) const = default;
};

/// What one robot (or one session) brings: a pose per cloud, and a way to read each cloud when it is needed. Scans of
/// a mission are never all in memory.
struct RobotLog {
  std::string name;
  std::string kind;  ///< what its source was recognised as, e.g. "GLIM dump"; empty where nothing was read from disk
  /// Scans: T_world_sensor of each, undistorted, in order. Finished submaps: T_world_submap of each.
  std::vector<Pose3> T_world_cloud;
  /// When each cloud was taken, where its source tells; else empty. Unix time or any other zero. [ns]
  std::vector<std::int64_t> stamps_ns;
  /// Of poses that were given in the place of a source's own, where their list has stamps; else empty. [ns]
  std::vector<std::int64_t> pose_stamps_ns;
  std::string stamp_unit;  ///< in which the source wrote them, known or guessed: "s", "ms", "us", "ns"; else empty
  /// What the source held before clouds and poses were brought together; equal to the size above where each had one.
  std::size_t clouds_found = 0;
  std::size_t poses_found = 0;
  bool poses_are_a_trajectory = false;  ///< clouds were looked up in it by time: it may well have more poses than they
  bool clouds_in_world = false;         ///< the source draws them in the world: read_cloud takes them back by the pose
  /// Where only a glance was asked for and reading all takes long: how many clouds follow that nobody looked at.
  std::size_t clouds_unread = 0;
  /// Each cloud is a whole submap in its own frame, not a scan: no sensor origin, so no free space but what read_cells
  /// brings.
  bool finished_submaps = false;
  /// Reads cloud i (0-based), in its own frame. May be called from several threads at once.
  std::function<Expected<PointCloud>(std::size_t)> read_cloud;
  /// Set where finished submaps are occupancy maps already, with their probabilities and what they know to be free:
  /// reads submap i, and build_submaps asks it instead of read_cloud. May be called from several threads at once.
  std::function<Expected<OccupancyCells>(std::size_t)> read_cells;
  /// Edge of their cells, as far as the first one tells. [m]
  std::optional<double> cell_size_m;
  /// Looks at cloud i without reading it. Empty where a source has no cheap way; nothing where it fails.
  std::function<std::optional<CloudPeek>(std::size_t)> peek_cloud;
  /// For messages: the file of cloud i.
  std::function<std::string(std::size_t)> cloud_name;
};

/// A robot's scans cut into submaps: the half-open ranges' first scans and lasts, included. Sorted, no gaps.
struct ScanRange {
  std::size_t first = 0;
  std::size_t last = 0;  ///< included
  bool operator==(const ScanRange&) const = default;
};

}  // namespace kilter
