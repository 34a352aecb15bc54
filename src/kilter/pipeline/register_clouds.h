// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "kilter/geometry/point_cloud.h"
#include "kilter/pipeline/measure_pair.h"

namespace kilter {

/// Two clouds of which one is brought onto the other.
struct CloudPair {
  PointCloud target;
  PointCloud source;
  Pose3 T_target_source_init;  ///< where to start; where nothing is known, the identity
  bool scans = false;  ///< single scans, each taken from its origin: rays tell free space, and range limits apply
  std::string target_name = "target";  ///< where messages are about it
  std::string source_name = "source";
};

/// Registers two clouds as `check` registers a pair of submaps: both become voxel maps, the local search runs from the
/// start, then always the wide search (options.registration.wide_translation_m, max_rotation_rad).
/// Gates on overlap do not apply. Vertical is the target's z.
/// \return  the measured pair; `evidence.registration` is always there and says how it ended. kInvalidPoints if a
/// cloud leaves no voxel.
[[nodiscard]] Expected<PairMeasurement> register_clouds(const CloudPair& clouds, const CheckOptions& options,
                                                        const RunContext& run);

}  // namespace kilter
