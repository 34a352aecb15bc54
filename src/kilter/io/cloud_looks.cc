// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/cloud_looks.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

namespace kilter {
namespace {

constexpr std::size_t kMostPairs = 6;  // along the way, and as many in turns
constexpr double kLeastWay_m = 1.0;    // less shows no difference between readings,
constexpr double kMostWay_m = 3.0;     // and more shows other places,
constexpr double kLongestStep_m = 15;  // which have to do where clouds lie farther apart
constexpr double kTurn_rad = 0.5;
constexpr double kVoxel_m = 0.3;
constexpr double kBorder_m = 0.06;
constexpr double kAtSensor_m = 0.1;      // where no return is written as zeros
constexpr std::size_t kFewPoints = 300;  // tell nothing
constexpr double kPoor = 0.7;            // of the next cloud's share
constexpr double kNear_m = 20.0;         // points beyond lie too far apart to meet
constexpr std::size_t kMostPoints = 6000;
constexpr double kGoAlong = 0.5;  // of the sensor's way, that clouds' middles may stray from it
// Middles of finished submaps say more of the rooms than of the way: 0.7 of it where they were in the world, 1.1 where
// they were in their own frames.
constexpr double kSubmapsGoAlong = 0.9;
constexpr double kMuchWorse = 0.8;
constexpr double kSameWay = 0.5;  // of the way as given, that other poses must lie apart to say anything

double way_m(const Pose3& a, const Pose3& b) { return (b.translation_m() - a.translation_m()).norm(); }

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
    if (point_m.norm() > kAtSensor_m && (point_m - sample.middle_m).norm() < kNear_m)
      sample.points_m.push_back(point_m);
  }
  return sample;
}

constexpr int kHalfCells = static_cast<int>(kNear_m / kVoxel_m) + 2;
constexpr std::size_t kCells = 2 * kHalfCells;  // on each axis

// Number of the cell at which coordinates from the lowest one lie, if it is one of them.
std::optional<std::size_t> cell_of(const Eigen::Vector3d& cells) {
  if (!((cells.array() >= 0.0).all() && (cells.array() < static_cast<double>(kCells)).all())) return std::nullopt;
  const Eigen::Matrix<std::size_t, 3, 1> at = cells.cast<std::size_t>();
  return (at.z() * kCells + at.y()) * kCells + at.x();
}

// RMS distance from their mean. [m]
double spread_m(const std::vector<Eigen::Vector3d>& places_m) {
  Eigen::Vector3d mean_m = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& place_m : places_m) mean_m += place_m / static_cast<double>(places_m.size());
  double squares_m2 = 0.0;
  for (const Eigen::Vector3d& place_m : places_m) squares_m2 += (place_m - mean_m).squaredNorm();
  return std::sqrt(squares_m2 / static_cast<double>(places_m.size()));
}

}  // namespace

CloudLooks::NearCells::NearCells(const std::vector<Eigen::Vector3d>& points_m, const Eigen::Vector3d& middle_m)
    : low_((middle_m.array() / kVoxel_m).floor() - kHalfCells), holds_(kCells * kCells * kCells) {
  // A surface that lies on a border of cells must not be lost by a hair.
  for (const Eigen::Vector3d& point_m : points_m) {
    for (int k = -3; k <= 3; ++k) {
      Eigen::Vector3d near_m = point_m;
      if (k != 0) near_m[std::abs(k) - 1] += k > 0 ? kBorder_m : -kBorder_m;
      if (const auto cell = cell_of(near_m / kVoxel_m - low_)) holds_[*cell] = true;
    }
  }
}

double CloudLooks::NearCells::share_of(const std::vector<Eigen::Vector3d>& points_m, const Pose3& T_cells_points,
                                       std::size_t every) const {
  const Eigen::Matrix3d turn = T_cells_points.rotation_matrix() / kVoxel_m;
  const Eigen::Vector3d shift = T_cells_points.translation_m() / kVoxel_m - low_;
  std::size_t met = 0;
  std::size_t asked = 0;
  for (std::size_t k = 0; k < points_m.size(); k += every, ++asked) {
    const auto cell = cell_of(turn * points_m[k] + shift);
    if (cell && holds_[*cell]) ++met;
  }
  return asked > 0 ? static_cast<double>(met) / static_cast<double>(asked) : 0.0;
}

CloudLooks::CloudLooks(const RobotLog& robot) : robot_(robot) {
  std::vector<Pair> way = pairs_on_the_way();
  const bool are_near = way.size() >= kFewestLooks;
  if (!are_near) way = pairs_of_neighbours();
  if (way.size() < kFewestLooks) return;
  for (const Pair& pair : way) look_at(pair, are_near);
  if (!robot.finished_submaps) {
    for (const Pair& pair : pairs_in_turns()) look_at(pair, false);
  }
  if (looks_.size() >= kFewestLooks) return;
  looks_.clear();
}

Shares CloudLooks::of(const Reading& reading, std::size_t every) const {
  Shares shares;
  Shares better;
  double way = 0.0;
  double way_as_given = 0.0;
  for (std::size_t k = 0; k < looks_.size(); ++k) {
    const Look& look = looks_[k];
    const std::optional<Pose3> T_first = reading.pose_of(look.pair.first);
    const std::optional<Pose3> T_second = reading.pose_of(look.pair.second);
    if (!T_first || !T_second) continue;
    way += way_m(*T_first, *T_second);
    way_as_given += way_m(first_pose(look), second_pose(look));
    const double meets = look.first.share_of(look.second_m, T_first->inverse() * *T_second, every);
    shares.meets += meets;
    shares.as_given += as_given_[k];
    ++shares.looks;
    if (meets < kMuchWorse * as_given_[k]) ++shares.worse;
    if (as_given_[k] > kMuchWorse * meets) continue;
    ++shares.better;
    better.meets += meets;
    better.as_given += as_given_[k];
  }
  // Where a robot stands still clouds meet in the sensor's frame, as its own body does.
  const bool stands = way < kSameWay * way_as_given && reading.kind != PoseReading::kCloudsInWorld;
  if (shares.looks == 0 || stands) return {};
  shares.gain_there = better.meets / std::max(better.as_given, kShareMore);
  shares.meets /= static_cast<double>(shares.looks);
  shares.as_given /= static_cast<double>(shares.looks);
  return shares;
}

double CloudLooks::mean(const std::vector<double>& shares) {
  return std::accumulate(shares.begin(), shares.end(), 0.0) / static_cast<double>(shares.size());
}

std::size_t CloudLooks::turns() const {
  return static_cast<std::size_t>(std::count_if(looks_.begin(), looks_.end(), [&](const Look& look) {
    return (first_pose(look).inverse() * second_pose(look)).angle_rad() >= kTurn_rad;
  }));
}

std::size_t CloudLooks::poor() const {
  std::size_t count = 0;
  for (std::size_t k = 0; k < looks_.size(); ++k) count += as_given_[k] < kPoor * next_meets_[k] ? 1 : 0;
  return count;
}

bool CloudLooks::go_along() const {
  std::vector<Eigen::Vector3d> sensors_m;
  std::vector<Eigen::Vector3d> off_sensors_m;
  for (const Look& look : looks_) {
    sensors_m.push_back(first_pose(look).translation_m());
    off_sensors_m.push_back(look.off_sensor_m);
  }
  return spread_m(off_sensors_m) < (robot_.finished_submaps ? kSubmapsGoAlong : kGoAlong) * spread_m(sensors_m);
}

std::vector<CloudLooks::Pair> CloudLooks::evenly(std::vector<Pair> pairs) {
  if (pairs.size() <= kMostPairs) return pairs;
  for (std::size_t k = 0; k < kMostPairs; ++k) pairs[k] = pairs[k * pairs.size() / kMostPairs];
  pairs.resize(kMostPairs);
  return pairs;
}

// Along the way; finished submaps with the next ones, however far they lie.
std::vector<CloudLooks::Pair> CloudLooks::pairs_on_the_way() const {
  const std::vector<Pose3>& poses = robot_.T_world_cloud;
  std::vector<Pair> pairs;
  std::size_t first = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    if (robot_.finished_submaps) {
      pairs.push_back({i - 1, i});
      continue;
    }
    const double way = way_m(poses[first], poses[i]);
    if (way < kLeastWay_m) continue;
    if (way <= kMostWay_m) pairs.push_back({first, i});
    first = i;
  }
  return evenly(std::move(pairs));
}

// Of clouds that lie farther apart.
std::vector<CloudLooks::Pair> CloudLooks::pairs_of_neighbours() const {
  const std::vector<Pose3>& poses = robot_.T_world_cloud;
  std::vector<Pair> pairs;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const double way = way_m(poses[i - 1], poses[i]);
    if (way >= kLeastWay_m && way <= kLongestStep_m) pairs.push_back({i - 1, i});
  }
  return evenly(std::move(pairs));
}

std::vector<CloudLooks::Pair> CloudLooks::pairs_in_turns() const {
  const std::vector<Pose3>& poses = robot_.T_world_cloud;
  std::vector<Pair> pairs;
  std::size_t first = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const bool is_near = way_m(poses[first], poses[i]) <= kMostWay_m;
    if (is_near && (poses[first].inverse() * poses[i]).angle_rad() < kTurn_rad) continue;
    if (is_near) pairs.push_back({first, i});
    first = i;
  }
  return evenly(std::move(pairs));
}

void CloudLooks::look_at(const Pair& pair, bool is_near) {
  Look look{pair, is_near, {}, {}, {}};
  const Sample first = sample_of(robot_, pair.first);
  look.first = NearCells(first.points_m, first.middle_m);
  look.second_m = sample_of(robot_, pair.second).points_m;
  const std::vector<Eigen::Vector3d> next_m =
      pair.first + 1 == pair.second ? look.second_m : sample_of(robot_, pair.first + 1).points_m;
  if (std::min(first.points_m.size(), std::min(look.second_m.size(), next_m.size())) < kFewPoints) return;
  look.off_sensor_m = first.middle_m - first_pose(look).translation_m();
  const Pose3& T_first = first_pose(look);
  const Pose3& T_second = second_pose(look);
  const Pose3& T_next = robot_.T_world_cloud[pair.first + 1];
  as_given_.push_back(look.first.share_of(look.second_m, T_first.inverse() * T_second, 1));
  const auto next_at = [&](const Pose3& T) { return look.first.share_of(next_m, T, 1); };
  next_meets_.push_back(
      std::max({next_at(Pose3()), next_at(T_first.inverse() * T_next), next_at(T_first * T_next.inverse())}));
  looks_.push_back(std::move(look));
}

double CloudLooks::median_near(const std::vector<double>& shares) const {
  std::vector<float> near;
  for (std::size_t k = 0; k < looks_.size(); ++k) {
    if (looks_[k].is_near) near.push_back(static_cast<float>(shares[k]));
  }
  return near.empty() ? 0.0 : median_of(std::move(near));
}

}  // namespace kilter
