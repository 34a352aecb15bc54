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

}  // namespace kilter::app
