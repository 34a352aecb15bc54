// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Identical racks in straight rows: every bay and every aisle looks like the next, and only the hall's walls and a
// few gaps in the shelves tell where one is.
#include <algorithm>
#include <cmath>

#include "kilter/simulation/props.h"
#include "kilter/simulation/worlds/worlds.h"

namespace kilter {
namespace {

using Eigen::Vector3d;

constexpr double kBay_m = 2.7;
constexpr double kRackDepth_m = 1.1;
constexpr double kAisle_m = 3.2;
constexpr double kPitch_m = kRackDepth_m + kAisle_m;
constexpr double kCross_m = 4.0;  // aisle across the rows' ends
constexpr double kHall_m = 7.0;   // height
constexpr double kLevels_m[] = {0.15, 1.85, 3.55};

// One bay: two uprights, three shelves, three pallets on each; a few are empty.
void add_bay(TriangleMesh& mesh, double x, double y, Rng& rng) {
  for (const double side : {-0.5, 0.5}) {
    mesh.add_box({.center_m = {x, y + side * kRackDepth_m, 2.6}, .size_m = {0.1, 0.1, 5.2}}, Material::kMetal);
  }
  for (const double level_m : kLevels_m) {
    mesh.add_box({.center_m = {x + 0.5 * kBay_m, y, level_m - 0.06}, .size_m = {kBay_m, kRackDepth_m, 0.12}},
                 Material::kMetal);
    for (int i = 0; i < 3; ++i) {
      if (rng.uniform() < 0.08) continue;
      mesh.add_box({.center_m = {x + 0.45 + 0.87 * i + 0.05, y, level_m + 0.55}, .size_m = {0.78, 1.0, 1.1}},
                   Material::kWood);
    }
  }
}

struct HallPlan {
  int racks = 4;
  double length_m = 24.3;

  [[nodiscard]] double rack_y_m(int i) const { return i * kPitch_m; }
  // Aisle i lies south of rack i; aisle `racks` is the northernmost.
  [[nodiscard]] double aisle_y_m(int i) const { return (i - 0.5) * kPitch_m; }
};

void build_hall(TriangleMesh& mesh, const HallPlan& plan, Rng& rng) {
  const double x0 = -kCross_m;
  const double x1 = plan.length_m + kCross_m;
  const double y0 = plan.aisle_y_m(0) - 0.5 * kAisle_m;
  const double y1 = plan.aisle_y_m(plan.racks) + 0.5 * kAisle_m;
  mesh.add_floor(x0, y0, x1, y1, 0.0, Material::kConcrete);
  mesh.add_floor(x0, y0, x1, y1, kHall_m, Material::kMetal);
  const Eigen::Vector2d corners[] = {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
  for (int i = 0; i < 4; ++i) {
    add_wall(mesh, {.start_m = corners[i], .end_m = corners[(i + 1) % 4], .height_m = kHall_m, .thickness_m = 0.2},
             Material::kMetal);
  }
  // Columns, gates and cabinets make the two short sides differ.
  for (double y = y0 + 3.0; y < y1; y += 7.0) {
    mesh.add_box({.center_m = {x0 + 0.3, y, 0.5 * kHall_m}, .size_m = {0.4, 0.4, kHall_m}}, Material::kConcrete);
    add_cabinet(mesh, {x1 - 0.4, y + rng.uniform(-1.0, 1.0), 0.0}, 0.0, rng);
  }
}

// Up aisle i, down aisle j, and the first aisle once more up to its middle.
std::vector<Vector3d> loop_route(const HallPlan& plan, int i, int j, Rng& rng) {
  const double side = rng.uniform(-0.3, 0.3);
  const double x0 = -0.5 * kCross_m + side;
  const double x1 = plan.length_m + 0.5 * kCross_m + side;
  const double y0 = plan.aisle_y_m(i) + side;
  const double y1 = plan.aisle_y_m(j) + side;
  const Vector3d start(0.3 * plan.length_m, y0, 0.0);
  return {start, {x1, y0, 0.0}, {x1, y1, 0.0}, {x0, y1, 0.0}, {x0, y0, 0.0}, {0.6 * plan.length_m, y0, 0.0}};
}

}  // namespace

Scene make_warehouse(const SceneOptions& options) {
  HallPlan plan;
  plan.racks = static_cast<int>(std::max(3L, std::lround(4.0 * options.scale)));
  plan.length_m = kBay_m * std::max(5.0, std::round(9.0 * options.scale));
  Scene scene;
  Rng furniture = part_rng(options, WorldPart::kFurniture);
  build_hall(scene.world.fixed, plan, furniture);
  for (int i = 0; i < plan.racks; ++i) {
    for (double x = 0.0; x < plan.length_m - 0.1; x += kBay_m)
      add_bay(scene.world.fixed, x, plan.rack_y_m(i), furniture);
  }
  Rng rng = part_rng(options, WorldPart::kRoutes);
  const int last = plan.racks;
  const int loops[5][2] = {{0, 1}, {2, 1}, {last, last - 1}, {0, last}, {1, last}};
  for (int r = 0; r < options.robots; ++r) {
    scene.routes.push_back({loop_route(plan, loops[r][0], loops[r][1], rng), {}, 0.0});
  }
  finish_routes(scene, options, {.speed_mps = 1.0, .sensor_height_m = 0.9});
  scene.faults = {{.kind = FaultKind::kMistakenPlace, .robot = 0, .at = 0.6, .size_m = kPitch_m}};
  return scene;
}

}  // namespace kilter
