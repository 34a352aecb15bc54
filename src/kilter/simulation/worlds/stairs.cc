// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Two storeys with the same plan and a staircase at one end: submaps of the two overlap in plan and share nothing.
#include <algorithm>
#include <cmath>

#include "kilter/simulation/worlds/storey.h"
#include "kilter/simulation/worlds/worlds.h"

namespace kilter {
namespace {

using Eigen::Vector3d;

constexpr double kStoreyPitch_m = 3.2;
constexpr double kHeight_m = 2.9;
constexpr double kHalfCorridor_m = 1.2;
constexpr double kRooms_m = 4.0;
constexpr double kWell_m = 7.0;      // length of the stairwell
constexpr double kFoot_m = 1.8;      // from the corridor's end to the first step
constexpr double kHalfWell_m = 2.6;  // and half its width
constexpr double kFlight_y_m = 1.3;
constexpr int kSteps = 10;  // per flight
constexpr double kRun_m = 0.3;

void build_storey(TriangleMesh& mesh, double floor_z_m, double length_m, Rng& rng) {
  Storey storey(mesh, floor_z_m, kHeight_m, rng);
  const double outer = kHalfCorridor_m + kRooms_m;
  storey.slabs({0.0, -outer, length_m, outer});
  storey.corridor_wall({length_m, -kHalfCorridor_m}, {0.0, -kHalfCorridor_m}, 4.0);
  storey.corridor_wall({0.0, kHalfCorridor_m}, {length_m, kHalfCorridor_m}, 4.0);
  storey.facade({length_m, -outer}, {0.0, -outer});
  storey.facade({0.0, outer}, {length_m, outer});
  storey.plain_wall({0.0, -outer}, {0.0, outer}, 0.3);
  storey.plain_wall({length_m, -outer}, {length_m, -kHalfCorridor_m}, 0.3);
  storey.plain_wall({length_m, kHalfCorridor_m}, {length_m, outer}, 0.3);
  const int rooms = static_cast<int>(length_m / 4.0);
  for (int i = 0; i < rooms; ++i) {
    const double x0 = i * length_m / rooms;
    const double x1 = (i + 1) * length_m / rooms;
    if (i > 0) storey.plain_wall({x0, -outer}, {x0, -kHalfCorridor_m});
    if (i > 0) storey.plain_wall({x0, kHalfCorridor_m}, {x0, outer});
    storey.furnish({x0, -outer, x1, -kHalfCorridor_m});
    storey.furnish({x0, kHalfCorridor_m, x1, outer});
  }
  storey.lamps({0.0, 0.0}, {length_m, 0.0});
}

// Steps from (x, z) upwards in the direction `sign` along x.
void add_flight(TriangleMesh& mesh, double x, double y, double z, double sign) {
  for (int i = 0; i < kSteps; ++i) {
    const double top = z + (i + 1) * 0.5 * kStoreyPitch_m / kSteps;
    mesh.add_box({.center_m = {x + sign * (i + 0.5) * kRun_m, y, top - 0.1}, .size_m = {kRun_m, 2.2, 0.2}},
                 Material::kConcrete);
  }
}

void build_stairwell(TriangleMesh& mesh, double x0) {
  const double x1 = x0 + kWell_m;
  const double top = kStoreyPitch_m + kHeight_m;
  mesh.add_floor(x0, -kHalfWell_m, x1, kHalfWell_m, 0.0, Material::kConcrete);
  mesh.add_floor(x0, -kHalfWell_m, x1, kHalfWell_m, top, Material::kPlaster);
  const auto wall = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    add_wall(mesh, {.start_m = a, .end_m = b, .height_m = top, .thickness_m = 0.3}, Material::kConcrete);
  };
  wall({x0, -kHalfWell_m}, {x1, -kHalfWell_m});
  wall({x1, -kHalfWell_m}, {x1, kHalfWell_m});
  wall({x1, kHalfWell_m}, {x0, kHalfWell_m});
  const double foot = x0 + kFoot_m;
  const double landing = foot + kSteps * kRun_m;
  add_flight(mesh, foot, -kFlight_y_m, 0.0, 1.0);
  add_flight(mesh, landing, kFlight_y_m, 0.5 * kStoreyPitch_m, -1.0);
  mesh.add_box({.center_m = {0.5 * (landing + x1), 0.0, 0.5 * kStoreyPitch_m - 0.1},
                .size_m = {x1 - landing, 2.0 * kHalfWell_m, 0.2}},
               Material::kConcrete);
  mesh.add_box({.center_m = {0.5 * (x0 + foot), 0.5 * kHalfWell_m - 0.6, kStoreyPitch_m - 0.15},
                .size_m = {foot - x0, kHalfWell_m + 1.2, 0.3}},
               Material::kConcrete);
}

// From the middle of the corridor downstairs over the stairs to the middle of the corridor upstairs.
std::vector<Vector3d> way_up(double length_m) {
  const double foot = length_m + kFoot_m;
  const double landing = foot + kSteps * kRun_m;
  const double half = 0.5 * kStoreyPitch_m;
  return {
      {foot - 0.9, 0.0, 0.0},           {foot - 0.9, -kFlight_y_m, 0.0},     {foot, -kFlight_y_m, 0.0},
      {landing, -kFlight_y_m, half},    {landing + 1.0, -kFlight_y_m, half}, {landing + 1.0, kFlight_y_m, half},
      {landing, kFlight_y_m, half},     {foot, kFlight_y_m, kStoreyPitch_m}, {foot - 0.9, kFlight_y_m, kStoreyPitch_m},
      {foot - 0.9, 0.0, kStoreyPitch_m}};
}

}  // namespace

Scene make_stairs(const SceneOptions& options) {
  Scene scene;
  const double length_m = 24.0 * options.scale;
  Rng furniture = part_rng(options, WorldPart::kFurniture);
  build_storey(scene.world.fixed, 0.0, length_m, furniture);
  build_storey(scene.world.fixed, kStoreyPitch_m, length_m, furniture);
  build_stairwell(scene.world.fixed, length_m);
  for (int r = 0; r < options.robots; ++r) {
    const double y = 0.15 * (r - 1);
    const double end = 2.0 + 0.05 * r * length_m;
    std::vector<Vector3d> way = way_up(length_m);
    way.insert(way.begin(), Vector3d(end, y, 0.0));
    way.emplace_back(end, y, kStoreyPitch_m);
    if (r % 2 == 1) std::reverse(way.begin(), way.end());
    const double z = way.back().z();
    way.emplace_back(0.6 * length_m, y, z);  // back along the corridor, which it knows
    scene.routes.push_back({way, {}, 0.0});
  }
  finish_routes(scene, options, {.speed_mps = 0.6, .corner_radius_m = 0.4, .sensor_height_m = 0.6});
  scene.scan_step_m = 0.7;
  scene.slam.closure_gap_m = 8.0;
  return scene;
}

}  // namespace kilter
