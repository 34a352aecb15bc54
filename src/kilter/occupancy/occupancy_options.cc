// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/occupancy/occupancy_options.h"

#include <fmt/format.h>

namespace kilter {

std::vector<OptionField> fields(OccupancyOptions& o) {
  return {
      real_option("resolution", o.resolution_m, Unit::kMetre, 0.005, 10.0, "Edge of an occupancy voxel."),
      real_option("min_range", o.min_range_m, Unit::kMetre, 0.0, 1000.0,
                  "Returns nearer than this (the robot itself) are ignored."),
      real_option("max_range", o.max_range_m, Unit::kMetre, 0.1, 10000.0,
                  "Returns farther than this only mark the first max_range of their ray as free."),
      real_option("probability_hit", o.probability_hit, Unit::kNone, 0.5, 0.999,
                  "Probability that a voxel in which a ray ends is occupied."),
      real_option("probability_miss", o.probability_miss, Unit::kNone, 0.001, 0.5,
                  "Probability that a voxel which a ray passes is occupied."),
      real_option("clamping_min", o.clamping_min, Unit::kNone, 0.0001, 0.5, "Lowest occupancy probability kept."),
      real_option("clamping_max", o.clamping_max, Unit::kNone, 0.5, 0.9999, "Highest occupancy probability kept."),
      real_option("occupancy_threshold", o.occupancy_threshold, Unit::kNone, 0.01, 0.99,
                  "A voxel is occupied from this probability on."),
  };
}

Expected<void> validate(const OccupancyOptions& o) {
  if (!(o.min_range_m < o.max_range_m)) {
    return fail(
        ErrorCode::kConfig,
        fmt::format("min_range: expected less than max_range, which is {} m, found {} m", o.max_range_m, o.min_range_m),
        {}, "lower min_range or raise max_range: returns between the two are what kilter works with");
  }
  // Log-odds are floats, so what is barely below may be equal.
  constexpr double kSame = 1e-6;
  if (o.clamping_max - o.occupancy_threshold < kSame) {
    return fail(ErrorCode::kConfig,
                fmt::format("occupancy_threshold: expected less than clamping_max, which is {}, found {}",
                            o.clamping_max, o.occupancy_threshold),
                {}, "lower occupancy_threshold or raise clamping_max, or no voxel is ever occupied");
  }
  if (o.occupancy_threshold - o.clamping_min < kSame) {
    return fail(ErrorCode::kConfig,
                fmt::format("occupancy_threshold: expected more than clamping_min, which is {}, found {}",
                            o.clamping_min, o.occupancy_threshold),
                {}, "raise occupancy_threshold or lower clamping_min, or no voxel is ever free");
  }
  if (o.occupancy_threshold - o.probability_miss < kSame) {
    return fail(ErrorCode::kConfig,
                fmt::format("occupancy_threshold: expected more than probability_miss, which is {}, found {}",
                            o.probability_miss, o.occupancy_threshold),
                {}, "raise occupancy_threshold or lower probability_miss, or what a ray passed is occupied");
  }
  return {};
}

}  // namespace kilter
