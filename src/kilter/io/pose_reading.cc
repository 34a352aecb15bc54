// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/pose_reading.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "kilter/occupancy/map_builder.h"

namespace kilter {
namespace {

constexpr std::size_t kMostPairs = 6;
constexpr std::size_t kFewestPairs = 3;
constexpr double kLeastWay_m = 1.0;  // less shows no difference between readings,
constexpr double kMostWay_m = 3.0;   // and more shows other places
constexpr double kVoxel_m = 0.3;
constexpr double kNear_m = 20.0;  // points beyond lie too far apart to meet
constexpr std::size_t kMostPoints = 6000;
constexpr double kGoAlong = 0.5;  // of the sensor's way, that clouds' middles may stray from it
// Middles of finished submaps say more of the rooms than of the way: 0.7 of it where they were in the world, 1.1 where
// they were in their own frames.
constexpr double kSubmapsGoAlong = 0.9;
constexpr double kMoreMeet = 1.25;  // times as many points, and
constexpr double kShareMore = 0.1;  // at least this share of them
// Under the right reading nearly as many points meet as of the next cloud, whose place hardly matters: 0.92 to 0.96 of
// them under inverted poses that were right, 0.44 (a car at speed) to 1 as given. Where a mounting was left out
// inverted poses fit better too, and reach 0.39 to 0.64, and 0.03 to 0.16 meet as given.
constexpr double kLikeNext = 0.7;
constexpr double kUnlikeNext = 0.25;

using Pair = std::pair<std::size_t, std::size_t>;

// Evenly along the way; finished submaps with the next ones, however far they lie.
std::vector<Pair> some_pairs(const RobotLog& robot) {
  const std::vector<Pose3>& poses = robot.T_world_cloud;
  std::vector<Pair> pairs;
  std::size_t first = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    if (robot.finished_submaps) {
      pairs.emplace_back(i - 1, i);
      continue;
    }
    const double way_m = (poses[i].translation_m() - poses[first].translation_m()).norm();
    if (way_m < kLeastWay_m) continue;
    if (way_m <= kMostWay_m) pairs.emplace_back(first, i);
    first = i;
  }
  if (pairs.size() <= kMostPairs) return pairs;
  for (std::size_t k = 0; k < kMostPairs; ++k) pairs[k] = pairs[k * pairs.size() / kMostPairs];
  pairs.resize(kMostPairs);
  return pairs;
}

// A sample of a cloud's points, of those near its middle, wherever that lies.
struct Sample {
  std::vector<Eigen::Vector3d> points_m;
  Eigen::Vector3d middle_m = Eigen::Vector3d::Zero();
};

double median_of(std::vector<float> values) {
  const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), half, values.end());
  return static_cast<double>(*half);
}

Sample sample_of(const RobotLog& robot, std::size_t i) {
  Sample sample;
  const Expected<PointCloud> cloud = robot.read_cloud(i);
  if (!cloud || cloud->points_m.empty()) return sample;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::vector<float> column(cloud->points_m.size());
    std::transform(cloud->points_m.begin(), cloud->points_m.end(), column.begin(),
                   [&](const Eigen::Vector3f& point_m) { return point_m[axis]; });
    sample.middle_m[axis] = median_of(std::move(column));
  }
  const std::size_t stride = cloud->points_m.size() / kMostPoints + 1;
  for (std::size_t k = 0; k < cloud->points_m.size(); k += stride) {
    const Eigen::Vector3d point_m = cloud->points_m[k].cast<double>();
    if ((point_m - sample.middle_m).norm() < kNear_m) sample.points_m.push_back(point_m);
  }
  return sample;
}

// RMS distance from their mean. [m]
double spread_m(const std::vector<Eigen::Vector3d>& places_m) {
  Eigen::Vector3d mean_m = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& place_m : places_m) mean_m += place_m / static_cast<double>(places_m.size());
  double squares_m2 = 0.0;
  for (const Eigen::Vector3d& place_m : places_m) squares_m2 += (place_m - mean_m).squaredNorm();
  return std::sqrt(squares_m2 / static_cast<double>(places_m.size()));
}

double share_that_meets(const std::vector<Eigen::Vector3d>& points_m, const Pose3& T_map_points, const VoxelMap& map) {
  if (points_m.empty()) return 0.0;
  const auto met = std::count_if(points_m.begin(), points_m.end(), [&](const Eigen::Vector3d& point_m) {
    return map.find_voxel(voxel_at(T_map_points * point_m, kVoxel_m)) >= 0;
  });
  return static_cast<double>(met) / static_cast<double>(points_m.size());
}

}  // namespace

std::optional<OtherReading> find_other_reading(const RobotLog& robot) {
  if (!robot.read_cloud) return std::nullopt;
  const std::vector<Pair> pairs = some_pairs(robot);
  if (pairs.size() < kFewestPairs) return std::nullopt;
  OtherReading in_world{PoseReading::kCloudsInWorld, 0.0, 0.0};
  OtherReading inverse{PoseReading::kInverse, 0.0, 0.0};
  double next_meets = 0.0;  // of the next cloud's points, wherever it may be: what a right reading comes near
  std::vector<Eigen::Vector3d> sensors_m;
  std::vector<Eigen::Vector3d> off_sensors_m;  // middles of clouds from where the poses have their sensors
  for (const auto& [i, k] : pairs) {
    const Sample first = sample_of(robot, i);
    const Sample second = sample_of(robot, k);
    MapBuilder builder({.resolution_m = kVoxel_m});
    builder.insert_points(first.points_m);
    const VoxelMap map = builder.finish();
    const Pose3& T_first = robot.T_world_cloud[i];
    const Pose3& T_second = robot.T_world_cloud[k];
    const double part = 1.0 / static_cast<double>(pairs.size());
    in_world.as_given += part * share_that_meets(second.points_m, T_first.inverse() * T_second, map);
    in_world.otherwise += part * share_that_meets(second.points_m, Pose3(), map);
    inverse.otherwise += part * share_that_meets(second.points_m, T_first * T_second.inverse(), map);
    const Pose3& T_next = robot.T_world_cloud[i + 1];
    const Sample next = i + 1 == k ? second : sample_of(robot, i + 1);
    const auto next_at = [&](const Pose3& T_first_next) { return share_that_meets(next.points_m, T_first_next, map); };
    next_meets +=
        part * std::max({next_at(Pose3()), next_at(T_first.inverse() * T_next), next_at(T_first * T_next.inverse())});
    sensors_m.push_back(T_first.translation_m());
    off_sensors_m.emplace_back(first.middle_m - T_first.translation_m());
  }
  inverse.as_given = in_world.as_given;
  // The robot's own body and the rings on the floor around it meet wherever it goes, in the sensor's frame. Clouds in
  // the world's frame go along with the poses.
  const double most_stray = robot.finished_submaps ? kSubmapsGoAlong : kGoAlong;
  const bool go_along = spread_m(off_sensors_m) < most_stray * spread_m(sensors_m);
  const OtherReading& better = go_along && in_world.otherwise > inverse.otherwise ? in_world : inverse;
  const bool is_clear =
      better.otherwise > kMoreMeet * better.as_given && better.otherwise > better.as_given + kShareMore;
  if (is_clear && (better.reading != PoseReading::kInverse || better.otherwise > kLikeNext * next_meets)) return better;
  // Finished submaps lie too far apart for what else they show to mean much.
  const bool is_neither =
      !robot.finished_submaps && next_meets > kShareMore && better.as_given < kUnlikeNext * next_meets;
  return is_neither ? std::optional(OtherReading{PoseReading::kNeither, better.as_given, next_meets}) : std::nullopt;
}

}  // namespace kilter
