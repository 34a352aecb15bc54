// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "testing/scenes.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "kilter/base/rng.h"
#include "kilter/occupancy/map_builder.h"

namespace kilter::testing {
namespace {

// Distance along the ray to the box's near side, or infinity. Boxes around the sensor are not entered.
double distance_to(const Box& box, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  double enter = 0.0;
  double leave = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) {
      if (origin[axis] < box.low_m[axis] || origin[axis] > box.high_m[axis]) return leave;
      continue;
    }
    double a = (box.low_m[axis] - origin[axis]) / direction[axis];
    double b = (box.high_m[axis] - origin[axis]) / direction[axis];
    if (a > b) std::swap(a, b);
    enter = std::max(enter, a);
    leave = std::min(leave, b);
  }
  return enter > 0.0 && enter <= leave ? enter : std::numeric_limits<double>::infinity();
}

}  // namespace

Scene furnished_room() {
  return {
      {{-0.2, -0.2, -0.2}, {12.2, 8.2, 0.0}},  // floor
      {{-0.2, -0.2, 3.0}, {12.2, 8.2, 3.2}},   // ceiling
      {{-0.2, -0.2, 0.0}, {0.0, 8.2, 3.0}},   {{12.0, -0.2, 0.0}, {12.2, 8.2, 3.0}},
      {{0.0, -0.2, 0.0}, {12.0, 0.0, 3.0}},   {{0.0, 8.0, 0.0}, {12.0, 8.2, 3.0}},
      {{2.0, 6.9, 0.0}, {4.1, 8.0, 2.1}},     {{8.3, 0.0, 0.0}, {9.6, 0.7, 1.8}},
      {{6.1, 4.4, 0.0}, {6.6, 4.9, 3.0}},     {{9.0, 5.1, 0.6}, {11.0, 6.3, 0.75}},
      {{0.0, 1.3, 0.0}, {0.5, 3.1, 1.1}},
  };
}

Scene bare_corridor() {
  return {{{-40.0, -1.7, -0.2}, {40.0, 1.7, 0.0}},
          {{-40.0, -1.7, 2.5}, {40.0, 1.7, 2.7}},
          {{-40.0, -1.7, 0.0}, {40.0, -1.5, 2.5}},
          {{-40.0, 1.5, 0.0}, {40.0, 1.7, 2.5}}};
}

std::vector<Eigen::Vector3d> scan(const Scene& scene, const Pose3& T_world_sensor, double noise_m, std::uint64_t seed,
                                  int beams, int columns) {
  Rng rng(seed, 77);
  std::vector<Eigen::Vector3d> points;
  for (int beam = 0; beam < beams; ++beam) {
    const double elevation = (-25.0 + 50.0 * (beam + 0.5) / beams) * std::numbers::pi / 180.0;
    for (int column = 0; column < columns; ++column) {
      const double azimuth = 2.0 * std::numbers::pi * (column + 0.31 * (beam % 3)) / columns;
      const Eigen::Vector3d ray(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                std::sin(elevation));
      const Eigen::Vector3d direction = T_world_sensor.rotation() * ray;
      double nearest = std::numeric_limits<double>::infinity();
      for (const Box& box : scene) {
        nearest = std::min(nearest, distance_to(box, T_world_sensor.translation_m(), direction));
      }
      const double noisy = nearest + noise_m * rng.normal();
      if (std::isfinite(nearest) && nearest < 60.0) points.emplace_back(ray * noisy);
    }
  }
  return points;
}

Submap submap_of(const Scene& scene, const std::vector<Pose3>& T_world_sensor, const Pose3& believed,
                 std::uint64_t seed, double noise_m) {
  Submap submap;
  submap.T_world_submap = believed;
  MapBuilder builder({.resolution_m = 0.1, .min_range_m = 0.3});
  for (std::size_t i = 0; i < T_world_sensor.size(); ++i) {
    const Pose3 T_submap_sensor = T_world_sensor.front().inverse() * T_world_sensor[i];
    std::vector<Eigen::Vector3d> points = scan(scene, T_world_sensor[i], noise_m, seed * 1000 + i);
    for (Eigen::Vector3d& point : points) point = T_submap_sensor * point;
    builder.insert_scan(points, T_submap_sensor.translation_m());
    submap.origins_m.push_back(T_submap_sensor.translation_m());
  }
  submap.map = builder.finish();
  return submap;
}

RobotLog robot_log(std::string name, const Scene& scene, const std::vector<Pose3>& truth,
                   const std::vector<Pose3>& believed, std::uint64_t seed, double noise_m) {
  RobotLog log;
  log.name = std::move(name);
  log.T_world_cloud = believed;
  log.cloud_name = [](std::size_t i) { return "scan " + std::to_string(i); };
  log.read_cloud = [=](std::size_t i) -> Expected<PointCloud> {
    PointCloud cloud;
    for (const Eigen::Vector3d& point : scan(scene, truth[i], noise_m, seed * 1000 + i)) {
      cloud.add(static_cast<float>(point.x()), static_cast<float>(point.y()), static_cast<float>(point.z()));
    }
    return cloud;
  };
  return log;
}

std::vector<Pose3> straight_path(const Eigen::Vector3d& from_m, const Eigen::Vector3d& direction, int count,
                                 double step_m) {
  const Eigen::Vector3d along = direction.normalized();
  const Eigen::Quaterniond heading(Eigen::AngleAxisd(std::atan2(along.y(), along.x()), Eigen::Vector3d::UnitZ()));
  std::vector<Pose3> poses;
  for (int i = 0; i < count; ++i) poses.emplace_back(heading, from_m + along * (step_m * i));
  return poses;
}

Pose3 pose_at(double x, double y, double z, double yaw) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())), {x, y, z}};
}

SubmapPair room_pair() {
  const Scene scene = furnished_room();
  const std::vector<Pose3> first = {pose_at(3.03, 2.52, 1.04, 0.1), pose_at(4.03, 3.02, 1.04, 0.3)};
  const std::vector<Pose3> second = {pose_at(8.21, 3.53, 1.02, 2.0), pose_at(7.51, 5.53, 1.02, 1.7)};
  return {submap_of(scene, first, first[0], 1), submap_of(scene, second, second[0], 2), first[0].inverse() * second[0]};
}

}  // namespace kilter::testing
