// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/pipeline/register_clouds.h"

#include <array>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "kilter/occupancy/map_builder.h"
#include "kilter/pipeline/submap_store.h"
#include "kilter/submap/build_submaps.h"

namespace kilter {
namespace {

tl::unexpected<Error> stopped() { return fail(ErrorCode::kCancelled, "stopped while making the two maps"); }

Expected<VoxelMap> map_of(const PointCloud& cloud, const std::optional<OccupancyCells>& cells, bool scan,
                          const std::string& name, const OccupancyOptions& options, const RunContext& run) {
  if (cells) return map_from_cells(*cells, options);
  MapBuilder builder(options);
  const std::size_t most_bytes = most_while_growing(run.memory_bytes);
  std::size_t held_bytes = 0;
  const MapBuilder::KeepGoing keep_going = [&](std::size_t bytes) {
    held_bytes = bytes;
    return !run.stop_requested() && held_bytes <= most_bytes;
  };
  const bool done = scan ? builder.insert_scan(cloud.points_m, Pose3(), keep_going)
                         : builder.insert_points(cloud.points_m, Pose3(), keep_going);
  if (run.stop_requested()) return stopped();
  if (held_bytes > most_bytes) return pass_up(too_large_while_growing(held_bytes, most_bytes, name));
  if (!done) return pass_up(too_much_of_a_scan(name));
  return builder.finish();
}

tl::unexpected<Error> refuse_bare(const CloudPair& clouds, bool is_target, const OccupancyOptions& options) {
  const std::string& name = is_target ? clouds.target_name : clouds.source_name;
  const std::size_t points = (is_target ? clouds.target : clouds.source).points_m.size();
  if (!clouds.scans) return fail(ErrorCode::kInvalidPoints, fmt::format("its {} points leave no voxel", points), name);
  return fail(ErrorCode::kInvalidPoints,
              fmt::format("none of its {} points leaves a voxel between min_range ({} m) and max_range ({} m)", points,
                          options.min_range_m, options.max_range_m),
              name, "widen the two");
}

}  // namespace

Expected<PairMeasurement> register_clouds(const CloudPair& clouds, const CheckOptions& options, const RunContext& run) {
  CheckOptions own = resolved(options);
  own.matching.overlap_min = 0.0;
  own.registration.always_search = true;  // one pair can afford it, and a start is often a guess
  const std::array<const PointCloud*, 2> sides = {&clouds.target, &clouds.source};
  const std::array<const std::optional<OccupancyCells>*, 2> cells = {&clouds.target_cells, &clouds.source_cells};
  std::array<std::unique_ptr<const SearchableMap>, 2> maps;
  std::array<std::optional<Error>, 2> errors;
  constexpr std::size_t kSteps = 3;  // two maps and a registration
  parallel_for(sides.size(), part_of(run, 0, kSteps), [&](std::size_t i) {
    Expected<VoxelMap> map = map_of(*sides[i], *cells[i], clouds.scans,
                                    i == 0 ? clouds.target_name : clouds.source_name, own.submap.occupancy, run);
    if (map) {
      maps[i] = std::make_unique<const SearchableMap>(*std::move(map), search_setup(own));
    } else {
      errors[i] = map.error();
    }
  });
  for (std::size_t i = 0; i < maps.size(); ++i) {
    if (errors[i]) return pass_up(*errors[i]);
    if (!maps[i]) return stopped();
    if (maps[i]->map().voxels().size() > 0) continue;
    return refuse_bare(clouds, i == 0, own.submap.occupancy);
  }
  const std::size_t bytes = maps[0]->bytes() + maps[1]->bytes();
  if (run.memory_bytes > 0 && bytes > run.memory_bytes) {
    return pass_up(exceeds_memory("the two together need", bytes, run.memory_bytes));
  }
  CandidatePair pair;
  pair.id = {{1}, {0}};
  pair.kind = PairKind::kGlobal;
  pair.predicted_enough = true;
  const Pose3 T_world_target;
  PairMeasurement measurement =
      measure_pair({{*maps[1], clouds.T_target_source_init}, {*maps[0], T_world_target}}, pair, own);
  std::optional<RegistrationResult>& registration = measurement.evidence.registration;
  if (!registration) registration.emplace().T_target_source = clouds.T_target_source_init;  // nothing to align
  if (run.progress) run.progress(kSteps, kSteps);
  return measurement;
}

}  // namespace kilter
