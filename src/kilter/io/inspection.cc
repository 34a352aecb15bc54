// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/inspection.h"

#include <algorithm>
#include <limits>

#include "kilter/io/find_oddities.h"
#include "kilter/io/octree_reader.h"
#include "kilter/io/usable_points.h"

namespace kilter {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();
constexpr std::size_t kMostPeeks = 2000;
constexpr std::size_t kMostSubmaps = 3000;  // pairs of which are counted

// All clouds where they are not too many; else every k-th.
std::optional<PointCount> count_points(const RobotLog& robot) {
  const std::size_t clouds = robot.T_world_cloud.size();
  if (!robot.peek_cloud || clouds == 0) return std::nullopt;
  const std::size_t stride = (clouds + kMostPeeks - 1) / kMostPeeks;
  PointCount count;
  std::size_t peeked = 0;
  for (std::size_t i = 0; i < clouds; i += stride, ++peeked) {
    const std::optional<CloudPeek> peek = robot.peek_cloud(i);
    if (!peek || !peek->points) return std::nullopt;
    count.points += *peek->points;
  }
  count.estimated = stride > 1;
  if (robot.clouds_unread > 0) count.estimated = true;
  if (count.estimated) count.points = count.points / peeked * (clouds + robot.clouds_unread);
  return count;
}

std::uint64_t occupied_voxels(const OccupancyCells& known) {
  std::uint64_t voxels = 0;
  for (const OccupancyCell& cell : known.cells) {
    if (cell.log_odds >= OccupancyCells::kOccupiedFrom) voxels += std::uint64_t{1} << (3 * cell.level);
  }
  return voxels;
}

// Nineteen of twenty points lie nearer; a few far ones do not make two submaps overlap.
std::optional<double> reach_of(const PointCloud& cloud, double max_range_m) {
  std::vector<float> ranges_m;
  for (const Eigen::Vector3f& point_m : cloud.points_m) {
    if (point_m.norm() <= max_range_m) ranges_m.push_back(point_m.norm());
  }
  if (ranges_m.empty()) return std::nullopt;
  const auto last = ranges_m.begin() + static_cast<std::ptrdiff_t>(ranges_m.size() * 19 / 20);
  std::nth_element(ranges_m.begin(), last, ranges_m.end());
  return *last;
}

// Octrees say how large they are only when they are read: as many as are read at once, the first in any case.
Expected<PointCount> count_voxels(const RobotLog& robot, std::optional<double>& reach_m) {
  constexpr std::size_t kMostLeaves = 5'000'000;
  const std::size_t trees = robot.T_world_cloud.size();
  PointCount count;
  std::size_t leaves = 0;
  std::size_t read = 0;
  for (; read < trees && leaves < kMostLeaves; ++read) {
    const Expected<OccupancyCells> known = robot.read_cells(read);
    if (!known) return pass_up(known.error());
    if (read == 0) reach_m = reach_of(occupied_centres(*known), kNoLimit);
    leaves += known->cells.size();
    count.points += occupied_voxels(*known);
  }
  count.estimated = read < trees;
  if (count.estimated) count.points = count.points / read * trees;
  return count;
}

double median_range_m(const PointCloud& cloud) {
  std::vector<float> ranges_m(cloud.points_m.size());
  std::transform(cloud.points_m.begin(), cloud.points_m.end(), ranges_m.begin(),
                 [](const Eigen::Vector3f& point_m) { return point_m.norm(); });
  const auto middle = ranges_m.begin() + static_cast<std::ptrdiff_t>(ranges_m.size() / 2);
  std::nth_element(ranges_m.begin(), middle, ranges_m.end());
  return *middle;
}

Expected<RobotInspection> look_at(const RobotLog& robot, std::size_t submaps, double max_range_m) {
  RobotInspection seen;
  seen.name = robot.name;
  seen.kind = robot.kind;
  seen.finished_submaps = robot.finished_submaps;
  seen.clouds = robot.T_world_cloud.size();
  seen.clouds_found = robot.clouds_found;
  seen.poses_found = robot.poses_found;
  seen.poses_are_a_trajectory = robot.poses_are_a_trajectory;
  seen.clouds_unread = robot.clouds_unread;
  seen.points = count_points(robot);
  seen.path_length_m = path_lengths_m(robot.T_world_cloud).back();
  for (const Pose3& pose : robot.T_world_cloud) seen.extent_world_m.extend(pose.translation_m());
  if (!robot.stamps_ns.empty()) {
    const auto [least, most] = std::minmax_element(robot.stamps_ns.begin(), robot.stamps_ns.end());
    seen.first_ns = *least;  // they need not be in order
    seen.last_ns = *most;
    seen.stamp_unit = robot.stamp_unit;
  }
  seen.likely_submaps = submaps;
  if (robot.read_cells) {
    const Expected<PointCount> voxels = count_voxels(robot, seen.reach_m);
    if (!voxels) return pass_up(voxels.error());
    seen.points = *voxels;
    seen.points_are_voxels = true;
  }
  if (!robot.read_cloud) return seen;  // occupancy maps have no points
  const Expected<PointCloud> cloud = robot.read_cloud(0);
  if (!cloud) return pass_up(cloud.error());
  if (cloud->points_m.empty()) {
    if (auto ok = check_usable(robot); !ok) return pass_up(ok.error());
  }
  seen.first_points = cloud->points_m.size();
  seen.first_dropped = cloud->dropped_nonfinite + cloud->dropped_far;
  if (!cloud->points_m.empty()) seen.median_range_m = median_range_m(*cloud);
  seen.reach_m = reach_of(*cloud, robot.finished_submaps ? kNoLimit : max_range_m);
  return seen;
}

// Where a likely submap's poses lie, and how far is seen from there.
struct Route {
  Eigen::AlignedBox3d box_world_m;
  double reach_m = 0.0;
};

std::vector<Route> submap_routes(const RobotLog& robot, const CuttingOptions& cutting) {
  std::vector<Route> routes;
  if (robot.finished_submaps) {
    for (const Pose3& pose : robot.T_world_cloud) routes.push_back({Eigen::AlignedBox3d(pose.translation_m())});
    return routes;
  }
  for (const ScanRange& range : cut_trajectory(robot.T_world_cloud, cutting)) {
    Eigen::AlignedBox3d& box = routes.emplace_back().box_world_m;
    for (std::size_t i = range.first; i <= range.last; ++i) box.extend(robot.T_world_cloud[i].translation_m());
  }
  return routes;
}

std::optional<std::size_t> count_pairs(const std::vector<Route>& routes) {
  if (routes.size() > kMostSubmaps) return std::nullopt;
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < routes.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const double apart_m = routes[i].box_world_m.exteriorDistance(routes[k].box_world_m);
      pairs += apart_m <= routes[i].reach_m + routes[k].reach_m ? 1 : 0;
    }
  }
  return pairs;
}

}  // namespace

Expected<Inspection> inspect(const Mission& mission, const SubmapOptions& options) {
  Inspection inspection;
  std::vector<Route> routes;
  for (const RobotLog& robot : mission.robots) {
    std::vector<Route> own = submap_routes(robot, options.cutting);
    Expected<RobotInspection> seen = look_at(robot, own.size(), options.occupancy.max_range_m);
    if (!seen) return pass_up(seen.error());
    for (Route& route : own) route.reach_m = seen->reach_m.value_or(options.cutting.submap_distance_m / 2.0);
    inspection.robots.push_back(*std::move(seen));
    routes.insert(routes.end(), own.begin(), own.end());
  }
  inspection.likely_submaps = routes.size();
  inspection.likely_pairs = count_pairs(routes);
  inspection.oddities = find_oddities(mission.robots, inspection.robots);
  return inspection;
}

}  // namespace kilter
