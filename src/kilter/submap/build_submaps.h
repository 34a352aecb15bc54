// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
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

/// Where one robot's submaps begin and end (Sec. III-A), before any scan is read.
///
/// \param robot_number  goes into SubmapNode::robot.
/// \param cuts          use these ranges instead of cutting; they must cover the log without gaps.
/// \return nodes in order with ids 0, 1, ... (to be renumbered by the caller), without what only scans tell
///   (`origins_m`, `dropped_points`); kCountMismatch if `cuts` do not fit.
[[nodiscard]] Expected<std::vector<SubmapNode>> plan_submaps(const RobotLog& log, int robot_number,
                                                             const CuttingOptions& options,
                                                             const std::optional<std::vector<ScanRange>>& cuts = {});

/// Builds the occupancy map of one planned submap from its own scans (Eq. 1). A finished submap comes from its points,
/// or from its cells as map_from_cells has it.
///
/// \param plan  one of what plan_submaps returned for the same log.
/// \return the submap; its first failing scan's error; kCancelled.
/// Cost: O(points * range / resolution); memory: its scans' points.
[[nodiscard]] Expected<Submap> build_submap(const RobotLog& log, SubmapNode plan, const OccupancyOptions& options,
                                            const RunContext& run);

/// How much a map may hold while it is made, where finished ones may take `memory_bytes` (0 = no limit). [bytes]
[[nodiscard]] std::size_t most_while_growing(std::size_t memory_bytes);

/// That a map would hold more.
[[nodiscard]] Error too_large_while_growing(std::size_t held_bytes, std::size_t most_bytes, std::string where);

/// All of one robot's submaps, planned and built, submaps in parallel.
///
/// \return submaps in order with ids 0, 1, ...; the first error of build_submap in scan order, after which no further
/// submap is begun, or of plan_submaps.
[[nodiscard]] Expected<std::vector<Submap>> build_submaps(const RobotLog& log, int robot_number,
                                                          const SubmapOptions& options, const RunContext& run,
                                                          const std::optional<std::vector<ScanRange>>& cuts = {});

}  // namespace kilter
