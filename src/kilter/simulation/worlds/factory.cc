// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A hall of columns, machines, tanks and pipes with aisles between them: round things, thin things, much that hides.
#include <algorithm>
#include <cmath>

#include "kilter/simulation/props.h"
#include "kilter/simulation/worlds/worlds.h"

namespace kilter {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kHall_m = 7.5;    // height
constexpr double kAisle_m = 3.6;   // width
constexpr double kIsland_m = 9.0;  // depth of what stands between two aisles
constexpr double kPitch_m = kAisle_m + kIsland_m;

// Aisles run along x at y = j * kPitch_m, and across at both ends and in the middle.
struct FactoryPlan {
  double length_m = 40.0;
  int islands = 2;  // rows of them, beside each other in y

  [[nodiscard]] double aisle_y_m(int j) const { return j * kPitch_m; }
  [[nodiscard]] double cross_x_m(int i) const { return 0.5 * i * length_m; }  // i = 0, 1, 2
};

void build_hall(TriangleMesh& mesh, const FactoryPlan& plan, Rng& rng) {
  const double x0 = -0.5 * kAisle_m - 1.0;
  const double x1 = plan.length_m + 0.5 * kAisle_m + 1.0;
  const double y0 = -0.5 * kAisle_m - 1.0;
  const double y1 = plan.aisle_y_m(plan.islands) + 0.5 * kAisle_m + 1.0;
  mesh.add_floor(x0, y0, x1, y1, 0.0, Material::kConcrete);
  mesh.add_floor(x0, y0, x1, y1, kHall_m, Material::kMetal);
  const Vector2d corners[] = {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
  for (int i = 0; i < 4; ++i) {
    Wall wall{.start_m = corners[i], .end_m = corners[(i + 1) % 4], .height_m = kHall_m, .thickness_m = 0.3};
    // Gates and windows, closed: what is seen in them lies a hand deep.
    const double length_m = (wall.end_m - wall.start_m).norm();
    for (double s = rng.uniform(1.5, 4.0); s + 3.5 < length_m; s += rng.uniform(5.0, 9.0)) {
      const bool gate = rng.uniform() < 0.3;
      wall.openings.push_back({s, s + (gate ? 3.2 : 2.4), gate ? 0.0 : 2.2, gate ? 3.4 : 4.0});
    }
    add_wall(mesh, wall, Material::kConcrete);
    const Vector2d along = (wall.end_m - wall.start_m) / length_m;
    const Vector2d outwards(along.y(), -along.x());
    wall.start_m += 0.25 * outwards;
    wall.end_m += 0.25 * outwards;
    wall.openings.clear();
    wall.thickness_m = 0.1;
    add_wall(mesh, wall, Material::kMetal);
  }
  for (double x = x0 + 1.0; x < x1; x += 5.0) {  // girders
    mesh.add_box({.center_m = {x, 0.5 * (y0 + y1), kHall_m - 0.4}, .size_m = {0.2, y1 - y0, 0.5}}, Material::kMetal);
  }
}

void add_tank(TriangleMesh& mesh, const Vector2d& at, double radius_m, Rng& rng) {
  const double legs_m = rng.uniform(0.3, 0.9);
  const double height_m = rng.uniform(1.8, 4.5);
  for (const auto& [sx, sy] : {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)}) {
    mesh.add_box({.center_m = {at.x() + 0.6 * sx * radius_m, at.y() + 0.6 * sy * radius_m, 0.5 * legs_m},
                  .size_m = {0.12, 0.12, legs_m}},
                 Material::kMetal);
  }
  mesh.add_prism({at.x(), at.y(), legs_m}, radius_m, radius_m, height_m, 20, Material::kMetal);
  mesh.add_prism({at.x(), at.y(), legs_m + height_m}, radius_m, 0.3 * radius_m, 0.4 * radius_m, 20, Material::kMetal);
}

// A bed with a tower and a cabinet beside it, of the given footprint.
void add_machine(TriangleMesh& mesh, const Vector2d& at, const Vector2d& size_m, Rng& rng) {
  const double bed_m = rng.uniform(0.7, 1.3);
  mesh.add_box({.center_m = {at.x(), at.y(), 0.5 * bed_m}, .size_m = {size_m.x(), size_m.y(), bed_m}},
               Material::kPaint);
  const double tower_m = rng.uniform(0.8, 2.2);
  const double share = rng.uniform(0.3, 0.6);
  mesh.add_box({.center_m = {at.x() + (rng.uniform() < 0.5 ? -0.5 : 0.5) * (1.0 - share) * size_m.x(), at.y(),
                             bed_m + 0.5 * tower_m},
                .size_m = {share * size_m.x(), rng.uniform(0.5, 0.9) * size_m.y(), tower_m}},
               Material::kPaint);
  mesh.add_prism({at.x(), at.y(), bed_m}, 0.12, 0.08, rng.uniform(0.5, 1.5), 10, Material::kMetal);
}

// Two to five pipes side by side along x on portals.
void add_pipes(TriangleMesh& mesh, double x0, double x1, double y, Rng& rng) {
  const double height_m = rng.uniform(3.2, 5.0);
  const int pipes = 2 + static_cast<int>(rng.uniform(0.0, 4.0));
  for (int i = 0; i < pipes; ++i) {
    const double thick_m = rng.uniform(0.12, 0.35);
    mesh.add_box({.center_m = {0.5 * (x0 + x1), y + 0.45 * (i - 0.5 * (pipes - 1)), height_m + 0.5 * thick_m},
                  .size_m = {x1 - x0, thick_m, thick_m}},
                 Material::kMetal);
  }
  for (double x = x0 + 0.3; x < x1; x += 4.0) {
    for (const double side : {-0.5, 0.5}) {
      mesh.add_box({.center_m = {x, y + side * 0.5 * pipes, 0.5 * height_m}, .size_m = {0.14, 0.14, height_m}},
                   Material::kMetal);
    }
    mesh.add_box({.center_m = {x, y, height_m - 0.08}, .size_m = {0.14, 0.5 * pipes, 0.14}}, Material::kMetal);
  }
}

// What stands between x0 and x1 on one side of the middle line of an island.
void fill_row(TriangleMesh& mesh, double x0, double x1, double y, double depth_m, Rng& rng) {
  double x = x0;
  while (true) {
    const double kind = rng.uniform();
    const double radius_m = rng.uniform(0.5, 0.45 * depth_m);
    const Vector2d size_m(rng.uniform(1.2, 4.0), rng.uniform(0.5, 0.9) * depth_m);
    const double width_m = kind < 0.35 ? 2.0 * radius_m : kind < 0.8 ? size_m.x() : 1.2;
    if (x + width_m > x1) return;
    const Vector2d at(x + 0.5 * width_m, y + rng.uniform(-0.1, 0.1));
    if (kind < 0.35) {
      add_tank(mesh, at, radius_m, rng);
    } else if (kind < 0.8) {
      add_machine(mesh, at, size_m, rng);
    } else if (kind < 0.9) {  // pallets
      const double height_m = 0.15 + 0.5 * std::floor(rng.uniform(1.0, 4.0));
      mesh.add_box({.center_m = {at.x(), at.y(), 0.5 * height_m}, .size_m = {1.2, 0.8, height_m}}, Material::kWood);
    }
    x += width_m + rng.uniform(0.4, 2.0);
  }
}

void build_islands(TriangleMesh& mesh, const FactoryPlan& plan, Rng& rng) {
  for (int j = 0; j < plan.islands; ++j) {
    for (int i = 0; i < 2; ++i) {
      const double x0 = plan.cross_x_m(i) + 0.5 * kAisle_m;
      const double x1 = plan.cross_x_m(i + 1) - 0.5 * kAisle_m;
      const double y0 = plan.aisle_y_m(j) + 0.5 * kAisle_m;
      const double row_m = (kIsland_m - 1.6) / 2.0;
      fill_row(mesh, x0, x1, y0 + 0.5 * row_m, row_m, rng);
      fill_row(mesh, x0, x1, y0 + kIsland_m - 0.5 * row_m, row_m, rng);
      if (rng.uniform() < 0.75) add_pipes(mesh, x0, x1, y0 + 0.5 * kIsland_m, rng);
      for (double x = x0 + 1.0; x < x1; x += 7.0) {
        mesh.add_box({.center_m = {x, y0 + 0.5 * kIsland_m, 0.5 * kHall_m}, .size_m = {0.4, 0.3, kHall_m}},
                     Material::kMetal);
      }
    }
  }
}

// Round the islands between two aisles and two aisles across, and on along the first, which it knows by then.
std::vector<Vector3d> ring_route(const FactoryPlan& plan, const Eigen::Vector4i& ring, bool clockwise, Rng& rng) {
  const double side = rng.uniform(-0.3, 0.3);
  const double x0 = plan.cross_x_m(ring[0]) + side;
  const double x1 = plan.cross_x_m(ring[1]) + side;
  const double y0 = plan.aisle_y_m(ring[2]) + side;
  const double y1 = plan.aisle_y_m(ring[3]) + side;
  std::vector<Vector3d> nodes = {{x0, y0, 0.0}, {x1, y0, 0.0}, {x1, y1, 0.0}, {x0, y1, 0.0}};
  if (clockwise) std::reverse(nodes.begin(), nodes.end());
  const Vector3d start = nodes[0] + 0.25 * (nodes[1] - nodes[0]);
  return {start, nodes[1], nodes[2], nodes[3], nodes[0], nodes[1], nodes[1] + 0.6 * (nodes[2] - nodes[1])};
}

void add_traffic(TriangleWorld& world, const FactoryPlan& plan, Rng& rng) {
  TriangleMesh forklift;
  forklift.add_box({.center_m = {0.0, 0.0, 0.6}, .size_m = {1.8, 1.1, 0.9}}, Material::kPaint);
  forklift.add_box({.center_m = {-0.3, 0.0, 1.95}, .size_m = {1.0, 1.0, 0.1}}, Material::kPaint);
  forklift.add_box({.center_m = {0.95, 0.0, 1.1}, .size_m = {0.1, 0.8, 2.0}}, Material::kMetal);
  MovingObject truck{forklift, {}, rng.uniform(1.2, 2.0), rng.uniform(0.0, 40.0)};
  const double y1 = plan.aisle_y_m(1) + 1.0;
  truck.circuit_m = {
      {-1.0, -1.0, 0.0}, {plan.length_m + 1.0, -1.0, 0.0}, {plan.length_m + 1.0, y1, 0.0}, {-1.0, y1, 0.0}};
  world.moving.push_back(truck);
  for (int j = 0; j <= plan.islands; ++j) {
    MovingObject walker{make_person(rng), {}, rng.uniform(0.8, 1.4), rng.uniform(0.0, 20.0)};
    const double y = plan.aisle_y_m(j) + 1.1;
    walker.circuit_m = {{rng.uniform(2.0, 0.4 * plan.length_m), y, 0.0},
                        {rng.uniform(0.6, 0.9) * plan.length_m, y, 0.0}};
    world.moving.push_back(walker);
  }
}

}  // namespace

Scene make_factory(const SceneOptions& options) {
  FactoryPlan plan;
  plan.length_m = 40.0 * options.scale;
  plan.islands = static_cast<int>(std::max(2L, std::lround(2.0 * options.scale)));
  Scene scene;
  Rng shell = part_rng(options, WorldPart::kPlan);
  build_hall(scene.world.fixed, plan, shell);
  Rng furniture = part_rng(options, WorldPart::kFurniture);
  build_islands(scene.world.fixed, plan, furniture);
  Rng traffic = part_rng(options, WorldPart::kTraffic);
  add_traffic(scene.world, plan, traffic);

  Rng rng = part_rng(options, WorldPart::kRoutes);
  const int last = plan.islands;
  const std::pair<Eigen::Vector4i, bool> rings[] = {{{0, 2, 0, 1}, false},
                                                    {{0, 2, 1, 2}, true},
                                                    {{0, 1, 0, last}, false},
                                                    {{1, 2, 0, last}, true},
                                                    {{0, 2, 0, last}, false}};
  for (int r = 0; r < options.robots; ++r) {
    scene.routes.push_back({ring_route(plan, rings[r].first, rings[r].second, rng), {}, 0.0});
  }
  finish_routes(scene, options, {.speed_mps = 0.9, .sensor_height_m = 0.8});
  scene.scan_step_m = 0.9;
  scene.faults = {
      {.kind = FaultKind::kMissedClosure, .robot = 0, .from = 0.2, .at = 0.6, .size_m = 0.4, .size_rad = 0.01}};
  if (options.robots >= 2) {
    scene.faults.push_back({.kind = FaultKind::kSlip, .robot = 1, .at = 0.45, .size_m = 0.25, .size_rad = 0.03});
  }
  return scene;
}

}  // namespace kilter
