// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/submap/build_submaps.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "kilter/base/lowest_failure.h"
#include "kilter/occupancy/map_builder.h"

namespace kilter {
namespace {

tl::unexpected<Error> stopped() { return fail(ErrorCode::kCancelled, "stopped while building submaps"); }

Expected<void> check_cuts(const RobotLog& log, const std::vector<ScanRange>& cuts) {
  std::size_t next = 0;
  for (const ScanRange& range : cuts) {
    if (range.first != next || range.last < range.first) {
      return fail(ErrorCode::kCountMismatch,
                  fmt::format("cuts of robot {} do not follow each other at scan {}", printable(log.name), next));
    }
    next = range.last + 1;
  }
  if (next != log.T_world_cloud.size()) {
    return fail(ErrorCode::kCountMismatch,
                fmt::format("cuts of robot {} cover {} scans, but it has {}", printable(log.name), next,
                            log.T_world_cloud.size()),
                {}, "use --cuts with a result made from the same scans");
  }
  return {};
}

std::vector<ScanRange> one_per_cloud(std::size_t count) {
  std::vector<ScanRange> ranges(count);
  for (std::size_t i = 0; i < count; ++i) ranges[i] = {i, i};
  return ranges;
}

// The first scan is the submap's frame: exactly the identity, so no rounding of the world pose reaches its voxels.
Pose3 pose_in_submap(const RobotLog& log, std::size_t first, std::size_t scan) {
  return scan == first ? Pose3() : log.T_world_cloud[first].inverse() * log.T_world_cloud[scan];
}

// A map that grows takes up to three and a half times what it takes once finished, and two finished ones fit the
// budget. Budgets below the least are about what is kept.
constexpr std::size_t kBudgetsWhileGrowing = 2;
constexpr std::size_t kLeastWhileGrowing = std::size_t{256} << 20;

Expected<void> integrate(const RobotLog& log, std::size_t scan, const Pose3& T_submap_scan, const RunContext& run,
                         MapBuilder& builder, Submap& submap) {
  Expected<PointCloud> cloud = log.read_cloud(scan);
  if (!cloud) return pass_up(cloud.error());
  submap.dropped_points += cloud->dropped_nonfinite + cloud->dropped_far;
  const std::size_t most_bytes = most_while_growing(run.memory_bytes);
  std::size_t held_bytes = 0;
  const auto fits = [&] { return held_bytes <= most_bytes; };
  const MapBuilder::KeepGoing keep_going = [&](std::size_t bytes) {
    held_bytes = bytes;
    return !run.stop_requested() && fits();
  };
  const bool done = log.finished_submaps ? builder.insert_points(cloud->points_m, T_submap_scan, keep_going)
                                         : builder.insert_scan(cloud->points_m, T_submap_scan, keep_going);
  if (run.stop_requested()) return stopped();
  if (!done && fits()) return pass_up(too_much_of_a_scan(log.cloud_name(scan)));
  if (!done) return pass_up(too_large_while_growing(held_bytes, most_bytes, log.cloud_name(scan)));
  if (!log.finished_submaps) submap.origins_m.push_back(T_submap_scan.translation_m());
  return {};
}

// A finished submap that is an occupancy map already.
Expected<VoxelMap> map_of_cells(const RobotLog& log, std::size_t number, const OccupancyOptions& options) {
  const Expected<OccupancyCells> cells = log.read_cells(number);
  if (!cells) return pass_up(cells.error());
  Expected<VoxelMap> map = map_from_cells(*cells, options);
  if (!map) map.error().where = log.cloud_name(number);
  return map;
}

Expected<VoxelMap> map_of_clouds(const RobotLog& log, const ScanRange& range, const OccupancyOptions& options,
                                 const RunContext& run, Submap& submap) {
  MapBuilder builder(options);
  for (std::size_t scan = range.first; scan <= range.last; ++scan) {
    if (run.stop_requested()) return stopped();
    const Expected<void> done = integrate(log, scan, pose_in_submap(log, range.first, scan), run, builder, submap);
    if (!done) return pass_up(done.error());
  }
  submap.dropped_points += builder.points_off_lattice();
  return builder.finish();
}

// What of the log a submap is made of: its scans, or the one finished submap of its number.
ScanRange clouds_of(const SubmapNode& node) {
  const auto number = static_cast<std::size_t>(node.index);
  return node.scans.value_or(ScanRange{number, number});
}

}  // namespace

std::size_t most_while_growing(std::size_t memory_bytes) {
  if (memory_bytes == 0) return std::numeric_limits<std::size_t>::max();
  return std::max(kBudgetsWhileGrowing * memory_bytes, kLeastWhileGrowing);
}

Error too_large_while_growing(std::size_t held_bytes, std::size_t most_bytes, std::string where) {
  return {ErrorCode::kOutOfMemory,
          fmt::format("the map that this cloud goes into takes {:.0f} MB while it is made, and may take {:.0f} MB",
                      static_cast<double>(held_bytes) / 1e6, static_cast<double>(most_bytes) / 1e6),
          std::move(where), "raise --memory, or use a coarser resolution or a smaller max_range"};
}

Expected<std::vector<SubmapNode>> plan_submaps(const RobotLog& log, int robot_number, const CuttingOptions& options,
                                               const std::optional<std::vector<ScanRange>>& cuts) {
  std::vector<ScanRange> ranges =
      log.finished_submaps ? one_per_cloud(log.T_world_cloud.size()) : cut_trajectory(log.T_world_cloud, options);
  if (cuts && !log.finished_submaps) {
    const Expected<void> fit = check_cuts(log, *cuts);
    if (!fit) return pass_up(fit.error());
    ranges = *cuts;
  }
  const std::vector<double> path = path_lengths_m(log.T_world_cloud);
  std::vector<SubmapNode> nodes(ranges.size());
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    SubmapNode& node = nodes[i];
    node.id = {static_cast<int>(i)};
    node.robot = robot_number;
    node.index = static_cast<int>(i);
    node.name = fmt::format("{}/{}", log.name, i + 1);
    if (!log.finished_submaps) node.scans = ranges[i];
    node.T_world_submap = log.T_world_cloud[ranges[i].first];
    node.path_start_m = path[ranges[i].first];
    node.path_end_m = path[ranges[i].last];
  }
  return nodes;
}

Expected<Submap> build_submap(const RobotLog& log, SubmapNode plan, const OccupancyOptions& options,
                              const RunContext& run) {
  Submap submap{std::move(plan), {}};
  const ScanRange clouds = clouds_of(submap);
  const bool has_cells = log.finished_submaps && log.read_cells;
  Expected<VoxelMap> map =
      has_cells ? map_of_cells(log, clouds.first, options) : map_of_clouds(log, clouds, options, run, submap);
  if (!map) return pass_up(map.error());
  submap.map = *std::move(map);
  return submap;
}

Expected<std::vector<Submap>> build_submaps(const RobotLog& log, int robot_number, const SubmapOptions& options,
                                            const RunContext& run, const std::optional<std::vector<ScanRange>>& cuts) {
  const Expected<std::vector<SubmapNode>> plan = plan_submaps(log, robot_number, options.cutting, cuts);
  if (!plan) return pass_up(plan.error());
  std::vector<Submap> submaps(plan->size());
  LowestFailure failure;
  parallel_for(plan->size(), run, [&](std::size_t i) {
    if (failure.is_before(i)) return;
    Expected<Submap> submap = build_submap(log, (*plan)[i], options.occupancy, run);
    if (!submap) return failure.keep(i, submap.error());
    submaps[i] = *std::move(submap);  // Eq. (1)
  });
  if (const auto done = failure.result(); !done) return pass_up(done.error());
  if (run.stop_requested()) return stopped();
  return submaps;
}

}  // namespace kilter
