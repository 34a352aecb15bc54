// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/base/parallel.h"
#include "kilter/occupancy/occupancy_options.h"
#include "kilter/submap/cutting.h"
#include "kilter/submap/submap.h"

namespace kilter {

struct SubmapOptions {
  CuttingOptions cutting;
  OccupancyOptions occupancy;
};

/// Cuts one robot's log into submaps and builds their occupancy maps (Sec. III-A, Eq. 1), submaps in parallel, each
/// reading its own scans. A finished submap is one of its own: from points, or from cells as map_from_cells has it.
///
/// \param robot_number  goes into Submap::robot.
/// \param cuts          use these ranges instead of cutting; they must cover the log without gaps.
/// \return submaps in order with ids 0, 1, ... (to be renumbered by the caller); the first failing scan's error in scan
///   order; kCountMismatch if `cuts` do not fit; kCancelled.
/// Cost: O(points * range / resolution); memory: one submap's scans per thread.
[[nodiscard]] Expected<std::vector<Submap>> build_submaps(const RobotLog& log, int robot_number,
                                                          const SubmapOptions& options, const RunContext& run,
                                                          const std::optional<std::vector<ScanRange>>& cuts = {});

}  // namespace kilter
