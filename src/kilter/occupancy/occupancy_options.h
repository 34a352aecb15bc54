// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "kilter/base/expected.h"
#include "kilter/base/option_table.h"

namespace kilter {

/// How scans become probabilistic occupancy voxels. Sensor model and clamping are OctoMap's defaults.
struct OccupancyOptions {
  double resolution_m = 0.1;         ///< edge of a voxel. [m]
  double min_range_m = 0.5;          ///< nearer returns (the robot itself) are ignored. [m]
  double max_range_m = 60.0;         ///< farther returns only free the first max_range_m of their ray. [m]
  double probability_hit = 0.7;      ///< P(occupied | a return ends here)
  double probability_miss = 0.4;     ///< P(occupied | a ray passes through)
  double clamping_min = 0.1192;      ///< lowest probability kept
  double clamping_max = 0.971;       ///< highest probability kept
  double occupancy_threshold = 0.5;  ///< occupied from this probability on
};

[[nodiscard]] std::vector<OptionField> fields(OccupancyOptions& options);

/// What no single option shows. \return kConfig: min_range leaves nothing below max_range, or occupancy_threshold is
/// not between what probabilities are clamped to.
[[nodiscard]] Expected<void> validate(const OccupancyOptions& options);

}  // namespace kilter
