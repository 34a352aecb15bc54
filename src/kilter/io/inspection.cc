// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/inspection.h"

#include <algorithm>

#include "kilter/io/find_oddities.h"
#include "kilter/io/usable_points.h"

namespace kilter {
namespace {

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

// Octrees say how large they are only when they are read: as many as are read at once, the first in any case.
Expected<PointCount> count_voxels(const RobotLog& robot) {
  constexpr std::size_t kMostLeaves = 5'000'000;
  const std::size_t trees = robot.T_world_cloud.size();
  PointCount count;
  std::size_t leaves = 0;
  std::size_t read = 0;
  for (; read < trees && leaves < kMostLeaves; ++read) {
    const Expected<OccupancyCells> known = robot.read_cells(read);
    if (!known) return pass_up(known.error());
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

Expected<RobotInspection> look_at(const RobotLog& robot, std::size_t submaps) {
  RobotInspection seen;
  seen.name = robot.name;
  seen.kind = robot.kind;
  seen.finished_submaps = robot.finished_submaps;
  seen.clouds = robot.T_world_cloud.size();
  seen.clouds_found = robot.clouds_found;
  seen.poses_found = robot.poses_found;
  seen.clouds_unread = robot.clouds_unread;
  seen.points = count_points(robot);
  seen.path_length_m = path_lengths_m(robot.T_world_cloud).back();
  for (const Pose3& pose : robot.T_world_cloud) seen.extent_world_m.extend(pose.translation_m());
  if (!robot.stamps_ns.empty()) {
    seen.first_ns = robot.stamps_ns.front();
    seen.last_ns = robot.stamps_ns.back();
    seen.stamp_unit = robot.stamp_unit;
  }
  seen.likely_submaps = submaps;
  if (robot.read_cells) {
    const Expected<PointCount> voxels = count_voxels(robot);
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
  return seen;
}

// Where each likely submap's poses lie.
std::vector<Eigen::AlignedBox3d> submap_routes(const RobotLog& robot, const CuttingOptions& cutting) {
  std::vector<Eigen::AlignedBox3d> routes;
  if (robot.finished_submaps) {
    for (const Pose3& pose : robot.T_world_cloud) routes.emplace_back(pose.translation_m());
    return routes;
  }
  for (const ScanRange& range : cut_trajectory(robot.T_world_cloud, cutting)) {
    Eigen::AlignedBox3d& route = routes.emplace_back();
    for (std::size_t i = range.first; i <= range.last; ++i) route.extend(robot.T_world_cloud[i].translation_m());
  }
  return routes;
}

std::optional<std::size_t> count_pairs(const std::vector<Eigen::AlignedBox3d>& routes, double near_m) {
  if (routes.size() > kMostSubmaps) return std::nullopt;
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < routes.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) pairs += routes[i].exteriorDistance(routes[k]) <= near_m ? 1 : 0;
  }
  return pairs;
}

}  // namespace

Expected<Inspection> inspect(const Mission& mission, const CuttingOptions& cutting) {
  Inspection inspection;
  std::vector<Eigen::AlignedBox3d> routes;
  for (const RobotLog& robot : mission.robots) {
    const std::vector<Eigen::AlignedBox3d> own = submap_routes(robot, cutting);
    Expected<RobotInspection> seen = look_at(robot, own.size());
    if (!seen) return pass_up(seen.error());
    inspection.robots.push_back(*std::move(seen));
    routes.insert(routes.end(), own.begin(), own.end());
  }
  inspection.likely_submaps = routes.size();
  inspection.likely_pairs = count_pairs(routes, cutting.submap_distance_m);
  inspection.oddities = find_oddities(mission.robots, inspection.robots);
  return inspection;
}

}  // namespace kilter
