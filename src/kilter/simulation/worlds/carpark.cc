// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Double rows of parked cars with aisles between them on nearly flat asphalt; a building along the north, trees and
// lamp posts, cars and people that move.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "kilter/simulation/props.h"
#include "kilter/simulation/worlds/worlds.h"

namespace kilter {
namespace {

using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;
constexpr double kBay_m = 2.6;
constexpr double kRowDepth_m = 10.0;  // two cars, nose to nose
constexpr double kAisle_m = 7.0;

double ground_m(double x, double y) { return 0.12 * std::sin(0.07 * x + 0.4) + 0.15 * std::sin(0.09 * y + 1.1); }

Vector3d on_ground(double x, double y) { return {x, y, ground_m(x, y)}; }

// Rows of bays along x, from x_m[0] to x_m[1]; y_m are their middles.
struct ParkPlan {
  double half_length_m = 13.0;
  std::vector<double> row_y_m;

  [[nodiscard]] double south_m() const { return row_y_m.front() - 0.5 * kRowDepth_m - kAisle_m; }
  [[nodiscard]] double north_m() const { return row_y_m.back() + 0.5 * kRowDepth_m + kAisle_m; }
  // Middle of the aisle south of row i; i = rows gives the northernmost.
  [[nodiscard]] double aisle_y_m(std::size_t i) const {
    return row_y_m.front() + (static_cast<double>(i) - 0.5) * (kRowDepth_m + kAisle_m);
  }
  [[nodiscard]] double side_x_m() const { return half_length_m + 0.5 * kAisle_m; }
};

ParkPlan make_plan(const SceneOptions& options) {
  ParkPlan plan;
  plan.half_length_m = 13.0 * options.scale;
  const auto rows = static_cast<int>(std::max(2L, std::lround(2.0 * options.scale)));
  for (int i = 0; i < rows; ++i) plan.row_y_m.push_back((i - 0.5 * (rows - 1)) * (kRowDepth_m + kAisle_m));
  return plan;
}

void park_cars(TriangleMesh& mesh, const ParkPlan& plan, Rng& rng) {
  for (const double row_y : plan.row_y_m) {
    for (double x = -plan.half_length_m + 0.5 * kBay_m; x < plan.half_length_m; x += kBay_m) {
      for (const double side : {-1.0, 1.0}) {
        if (rng.uniform() > 0.7) continue;
        const double y = row_y + side * (2.6 + rng.uniform(-0.2, 0.2));
        const double yaw_rad = (rng.uniform() < 0.6 ? 0.5 : -0.5) * kPi + rng.uniform(-0.05, 0.05);
        mesh.append(rng.uniform() < 0.12 ? make_van(rng) : make_car(rng), standing_at(on_ground(x, y), yaw_rad));
      }
    }
    for (const double side : {-1.0, 1.0}) {
      const double x = side * (plan.half_length_m + 0.6);
      mesh.add_box({.center_m = on_ground(x, row_y), .size_m = {1.0, 0.9 * kRowDepth_m, 0.3}}, Material::kConcrete);
      add_tree(mesh, on_ground(x, row_y + rng.uniform(-2.0, 2.0)), rng.uniform(4.5, 7.0), rng.uniform(1.4, 2.2), rng);
    }
    add_lamp_post(mesh, on_ground(rng.uniform(-0.4, 0.4) * plan.half_length_m, row_y), 7.0);
  }
}

// A building with deep window bays along the north, hedges and trees along the other sides.
void build_surroundings(TriangleMesh& mesh, const ParkPlan& plan, Rng& rng) {
  const double reach_m = plan.side_x_m() + 6.0;
  Wall facade{.start_m = {-reach_m, plan.north_m() + 3.0},
              .end_m = {reach_m - 4.0, plan.north_m() + 3.0},
              .floor_z_m = -0.5,
              .height_m = 9.0,
              .thickness_m = 0.5};
  for (double x = 2.0; x + 2.0 < 2.0 * reach_m - 4.0; x += 4.0 + rng.uniform(0.0, 1.5)) {
    facade.openings.push_back({x, x + 1.8, 1.6, 3.4});
  }
  add_wall(mesh, facade, Material::kConcrete);
  // What is seen through the windows.
  mesh.add_box({.center_m = {-2.0, plan.north_m() + 5.0, 4.0}, .size_m = {2.0 * reach_m, 0.2, 9.0}},
               Material::kPlaster);
  for (double x = -reach_m; x < reach_m; x += 5.0 + rng.uniform(0.0, 3.0)) {
    add_tree(mesh, on_ground(x, plan.south_m() - 2.5 - rng.uniform(0.0, 2.0)), rng.uniform(5.0, 9.0),
             rng.uniform(1.5, 2.6), rng);
  }
  for (double y = plan.south_m(); y < plan.north_m(); y += 6.0 + rng.uniform(0.0, 2.0)) {
    mesh.add_box(
        {.center_m = on_ground(-reach_m, y) + Vector3d(0.0, 0.0, 0.5), .size_m = {0.8, rng.uniform(3.0, 5.0), 1.0}},
        Material::kFoliage);
    add_lamp_post(mesh, on_ground(reach_m, y), 6.0);
  }
}

// Cars drive round rows on the right of the aisle's middle, people walk along the sides.
void add_traffic(TriangleWorld& world, const ParkPlan& plan, Rng& rng) {
  const double x = plan.side_x_m() + 1.8;
  for (std::size_t i = 0; i < plan.row_y_m.size(); ++i) {
    const double y0 = plan.aisle_y_m(i) - 1.8;
    const double y1 = plan.aisle_y_m(i + 1) + 1.8;
    MovingObject car{make_car(rng), {}, rng.uniform(2.0, 4.0), rng.uniform(0.0, 60.0)};
    car.circuit_m = {on_ground(-x, y0), on_ground(x, y0), on_ground(x, y1), on_ground(-x, y1)};
    world.moving.push_back(car);
    MovingObject walker{make_person(rng), {}, rng.uniform(0.9, 1.5), rng.uniform(0.0, 30.0)};
    const double walk_x = rng.uniform(-0.8, 0.8) * plan.half_length_m;
    walker.circuit_m = {on_ground(walk_x, y0 + 0.5), on_ground(walk_x + rng.uniform(-6.0, 6.0), y1 - 0.5)};
    world.moving.push_back(walker);
  }
}

// Round the rows [first, last), then on until the second corner.
std::vector<Vector3d> ring_route(const ParkPlan& plan, std::size_t first, std::size_t last, bool clockwise, Rng& rng) {
  const double side = rng.uniform(-0.5, 0.5);
  const double x = plan.side_x_m() - 0.8 + side;
  const double y0 = plan.aisle_y_m(first) + side;
  const double y1 = plan.aisle_y_m(last) + side;
  std::vector<Vector3d> nodes = {on_ground(-x, y0), on_ground(x, y0), on_ground(x, y1), on_ground(-x, y1)};
  if (clockwise) nodes = {on_ground(x, y1), on_ground(x, y0), on_ground(-x, y0), on_ground(-x, y1)};
  const Vector3d start = nodes[0] + 0.3 * (nodes[1] - nodes[0]);
  return {start, nodes[1], nodes[2], nodes[3], nodes[0], start, nodes[1]};
}

}  // namespace

Scene make_carpark(const SceneOptions& options) {
  const ParkPlan plan = make_plan(options);
  Scene scene;
  Rng street = part_rng(options, WorldPart::kStreet);
  const double reach_m = plan.side_x_m() + 40.0;
  scene.world.fixed.add_terrain(-reach_m, plan.south_m() - 30.0, reach_m, plan.north_m() + 30.0, 2.0, ground_m,
                                Material::kAsphalt);
  park_cars(scene.world.fixed, plan, street);
  Rng plants = part_rng(options, WorldPart::kPlants);
  build_surroundings(scene.world.fixed, plan, plants);
  Rng traffic = part_rng(options, WorldPart::kTraffic);
  add_traffic(scene.world, plan, traffic);

  Rng rng = part_rng(options, WorldPart::kRoutes);
  const std::size_t rows = plan.row_y_m.size();
  const std::vector<std::vector<Vector3d>> rings = {
      ring_route(plan, 0, 1, false, rng), ring_route(plan, rows - 1, rows, true, rng),
      ring_route(plan, 0, rows, false, rng), ring_route(plan, 0, 1, true, rng),
      ring_route(plan, rows - 1, rows, false, rng)};
  for (int r = 0; r < options.robots; ++r) scene.routes.push_back({rings[static_cast<std::size_t>(r)], {}, 0.0});
  finish_routes(scene, options, {.speed_mps = 1.4, .corner_radius_m = 2.0, .sensor_height_m = 1.1, .sway_rad = 0.008});
  scene.scan_step_m = 1.0;
  scene.slam.closure_distance_m = 2.5;
  scene.slam.closure_spacing_m = 4.0;
  scene.faults = {
      {.kind = FaultKind::kMissedClosure, .robot = 0, .from = 0.3, .at = 0.75, .size_m = 1.2, .size_rad = 0.02}};
  if (options.robots >= 2) {
    scene.faults.push_back({.kind = FaultKind::kSlip, .robot = 1, .at = 0.4, .size_m = 0.5, .size_rad = 0.05});
  }
  return scene;
}

}  // namespace kilter
