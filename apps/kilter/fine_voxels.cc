// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/fine_voxels.h"

#include <fmt/format.h>

namespace kilter::app {

std::optional<std::string> note_on_fine_voxels(const OccupancyOptions& options) {
  constexpr double kWorthAWord = 10.0;
  const double usual_m = OccupancyOptions().resolution_m;
  // Time and memory, measured in a room and on a drive, grow by powers of 1.8 to 2.4.
  const double times = usual_m * usual_m / (options.resolution_m * options.resolution_m);
  if (times < kWorthAWord) return std::nullopt;
  return fmt::format(
      "resolution = {} m takes some {:.0f} times the time and memory of {} m; a coarser one or a smaller max_range is "
      "quicker, and voxels finer than the points are dense show no more",
      options.resolution_m, times, usual_m);
}

std::optional<std::string> note_on_fine_tolerance(const CheckOptions& options) {
  constexpr double kTellable = 10.0;  // a tenth of a voxel
  const double tolerance_m = options.judge.tolerance_m;
  const double resolution_m = options.submap.occupancy.resolution_m;
  if (options.judge.method == JudgeMethod::kGamma || kTellable * tolerance_m >= resolution_m) return std::nullopt;
  return fmt::format(
      "tolerance = {} m is below what voxels of {} m tell: few pairs will be decided; a finer resolution or a larger "
      "tolerance is of more use",
      tolerance_m, resolution_m);
}

}  // namespace kilter::app
