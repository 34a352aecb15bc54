// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "kilter/geometry/point_cloud.h"
#include "kilter/occupancy/occupancy_cells.h"
#include "kilter/pipeline/measure_pair.h"

namespace kilter {

/// Two clouds of which one is brought onto the other.
struct CloudPair {
  PointCloud target;
  PointCloud source;
  Pose3 T_target_source_init;                       ///< where to start; where nothing is known, the identity
  std::optional<OccupancyCells> target_cells = {};  ///< where a tree is what the cloud was read from: it is compared
  std::optional<OccupancyCells> source_cells = {};  ///< as a finished submap from a tree is, and the cloud only shown
  bool scans = false;  ///< single scans, each taken from its origin: rays tell free space, and range limits apply
  std::string target_name = "target";  ///< where messages are about it
  std::string source_name = "source";
};

/// Registers two clouds as `check` registers a pair of submaps: both become voxel maps, the local search runs from the
/// start, then always the wide search (options.registration.wide_translation_m, max_rotation_rad).
/// Gates on overlap do not apply. Vertical is the target's z.
/// \return  the measured pair; `evidence.registration` is always there and says how it ended. kInvalidPoints if a
/// cloud leaves no voxel, kOutOfMemory if the two maps exceed run.memory_bytes; what map_from_cells fails with.
[[nodiscard]] Expected<PairMeasurement> register_clouds(const CloudPair& clouds, const CheckOptions& options,
                                                        const RunContext& run);

}  // namespace kilter
