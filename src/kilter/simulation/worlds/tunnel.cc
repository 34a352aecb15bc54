// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A straight tunnel whose ends lie beyond the lidar's reach: sliding along it changes nothing that can be seen,
// unless it has niches.
#include <cmath>
#include <numbers>

#include "kilter/simulation/props.h"
#include "kilter/simulation/worlds/worlds.h"

namespace kilter {
namespace {

constexpr double kHalfWidth_m = 2.6;
constexpr double kWallHeight_m = 2.2;
constexpr double kBeyondReach_m = 160.0;
constexpr int kVaultFacets = 8;

void add_vault(TriangleMesh& mesh, double x0, double x1) {
  const auto rim = [](double x, int i) {
    const double angle = std::numbers::pi * i / kVaultFacets;
    return Eigen::Vector3d(x, kHalfWidth_m * std::cos(angle), kWallHeight_m + 0.6 * kHalfWidth_m * std::sin(angle));
  };
  for (int i = 0; i < kVaultFacets; ++i) {
    mesh.add_quad(rim(x0, i), rim(x1, i), rim(x1, i + 1), rim(x0, i + 1), Material::kConcrete);
  }
}

// A recess behind an opening of the wall: back, sides, lid.
void add_niche(TriangleMesh& mesh, double x, double y_sign) {
  const double inner = kHalfWidth_m + 0.3;
  const auto box = [&](double dx, double dy, double z, double sx, double sy, double sz) {
    mesh.add_box({.center_m = {x + dx, y_sign * (inner + dy), z}, .size_m = {sx, sy, sz}}, Material::kConcrete);
  };
  box(0.0, 0.85, 1.05, 2.0, 0.1, 2.1);
  box(-0.85, 0.4, 1.05, 0.1, 0.9, 2.1);
  box(0.85, 0.4, 1.05, 0.1, 0.9, 2.1);
  box(0.0, 0.4, 2.05, 2.0, 0.9, 0.1);
}

}  // namespace

Scene make_tunnel(const SceneOptions& options, bool niches) {
  Scene scene;
  TriangleMesh& mesh = scene.world.fixed;
  const double drive_m = 60.0 * options.scale;
  const double x0 = -kBeyondReach_m;
  const double x1 = drive_m + kBeyondReach_m;
  Rng rng = part_rng(options, WorldPart::kPlan);
  mesh.add_floor(x0, -kHalfWidth_m - 1.5, x1, kHalfWidth_m + 1.5, 0.0, Material::kConcrete);
  add_vault(mesh, x0, x1);
  for (const double side : {-1.0, 1.0}) {
    Wall wall{.start_m = {x0, side * (kHalfWidth_m + 0.15)},
              .end_m = {x1, side * (kHalfWidth_m + 0.15)},
              .height_m = kWallHeight_m,
              .thickness_m = 0.3};
    for (double x = rng.uniform(4.0, 10.0); niches && x < drive_m; x += rng.uniform(12.0, 20.0)) {
      wall.openings.push_back({x - x0 - 0.8, x - x0 + 0.8, 0.0, 2.0});
      add_niche(mesh, x, side);
    }
    add_wall(mesh, wall, Material::kConcrete);
  }
  for (int r = 0; r < options.robots; ++r) {
    const double y = 0.6 * (r % 2 == 0 ? 1.0 : -1.0);
    const double first = 0.1 * r * drive_m;
    const double turn = drive_m - 0.05 * r * drive_m;
    scene.routes.push_back({{{first, y, 0.0}, {turn, y, 0.0}, {turn, -y, 0.0}, {0.4 * drive_m, -y, 0.0}}, {}, 0.0});
  }
  finish_routes(scene, options, {.speed_mps = 1.2, .sensor_height_m = 1.0});
  // What the geometry does not fix, the front end does not know either: it loses its way along the tunnel.
  scene.slam.drift.bias_m_per_m = {niches ? 0.003 : 0.02, 0.001, 0.001};
  scene.slam.within_robots = scene.slam.between_robots = niches;
  scene.slam.closure_distance_m = 2.0;
  return scene;
}

}  // namespace kilter
