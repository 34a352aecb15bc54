// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Trunks, crowns and undergrowth on uneven ground: little that is flat, nothing that is straight.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "kilter/simulation/props.h"
#include "kilter/simulation/worlds/worlds.h"

namespace kilter {
namespace {

using Eigen::Vector3d;

double ground_m(double x, double y) {
  return 0.5 * std::sin(0.11 * x + 0.3) * std::cos(0.09 * y) + 0.12 * std::sin(0.5 * x + 0.7 * y) +
         0.05 * std::sin(1.9 * x - 1.3 * y);
}

// A robot's way round a rough circle, and a quarter of it once more.
std::vector<Vector3d> loop_route(double center_x, double center_y, double radius_m, double start_rad, double sign,
                                 Rng& rng) {
  constexpr int kCorners = 14;
  std::vector<Vector3d> corners;
  for (int i = 0; i < kCorners; ++i) {
    const double angle = start_rad + sign * 2.0 * std::numbers::pi * i / kCorners;
    const double r = radius_m * rng.uniform(0.93, 1.07);
    corners.emplace_back(center_x + r * std::cos(angle), center_y + r * std::sin(angle), 0.0);
  }
  for (int i = 0; i < 4; ++i) corners.push_back(corners[static_cast<std::size_t>(i)]);
  // Finer corners so that the robot follows the ground.
  std::vector<Vector3d> route;
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    const Vector3d leg = corners[i + 1] - corners[i];
    const int parts = std::max(1, static_cast<int>(leg.norm() / 1.5));
    for (int k = 0; k < parts; ++k) route.push_back(corners[i] + static_cast<double>(k) / parts * leg);
  }
  for (Vector3d& corner : route) corner.z() = ground_m(corner.x(), corner.y());
  return route;
}

bool on_a_route(const Scene& scene, double x, double y) {
  constexpr double kClear_m = 1.3;
  for (const RobotRoute& route : scene.routes) {
    for (const Vector3d& corner : route.corners_m) {
      if (std::hypot(corner.x() - x, corner.y() - y) < kClear_m + 0.5) return true;
    }
  }
  return false;
}

}  // namespace

Scene make_forest(const SceneOptions& options) {
  Scene scene;
  const double radius_m = 11.0 * options.scale;
  Rng rng = part_rng(options, WorldPart::kRoutes);
  for (int r = 0; r < options.robots; ++r) {
    // Circles round points that are one radius apart, so that each crosses the others.
    const double angle = 2.0 * r;
    const double off_m = r == 0 ? 0.0 : radius_m;
    scene.routes.push_back({loop_route(off_m * std::cos(angle), off_m * std::sin(angle), radius_m, angle + 0.5 * r,
                                       r % 2 == 0 ? 1.0 : -1.0, rng),
                            {},
                            0.0});
  }
  const double reach_m = 2.0 * radius_m + 18.0;
  TriangleMesh& mesh = scene.world.fixed;
  mesh.add_terrain(-reach_m, -reach_m, reach_m, reach_m, 0.8, ground_m, Material::kFoliage);
  Rng plants = part_rng(options, WorldPart::kPlants);
  const int trees = static_cast<int>(0.035 * 4.0 * reach_m * reach_m);
  for (int i = 0; i < trees; ++i) {
    const double x = plants.uniform(-reach_m, reach_m);
    const double y = plants.uniform(-reach_m, reach_m);
    const double height_m = plants.uniform(6.0, 14.0);
    if (on_a_route(scene, x, y)) continue;
    const Vector3d at(x, y, ground_m(x, y));
    if (plants.uniform() < 0.25) {
      mesh.add_leaves(at + Vector3d(0.0, 0.0, 0.4), {0.5, 0.5, 0.5}, 80, plants);
    } else {
      add_tree(mesh, at, height_m, plants.uniform(1.2, 2.4), plants);
    }
  }
  finish_routes(scene, options,
                {.speed_mps = 0.9, .corner_radius_m = 1.0, .sensor_height_m = 0.9, .sway_rad = 0.015, .heave_m = 0.01});
  scene.scan_step_m = 1.0;
  scene.slam.closure_distance_m = 2.5;
  scene.faults = {{.kind = FaultKind::kWrongClosure, .robot = 0, .at = 0.85, .size_m = 0.8}};
  return scene;
}

}  // namespace kilter
