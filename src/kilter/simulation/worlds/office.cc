// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Blocks of rooms on a grid with corridors between and around them, so that corridors form rings, and a strip of
// rooms along the outer walls.
#include <algorithm>
#include <cmath>
#include <optional>

#include "kilter/simulation/worlds/storey.h"
#include "kilter/simulation/worlds/worlds.h"

namespace kilter {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kCorridor_m = 2.2;
constexpr double kOuterRooms_m = 5.0;
constexpr double kHeight_m = 2.7;
constexpr double kDoorSpacing_m = 4.5;

// Centre lines of the corridors along y (x_m) and along x (y_m).
struct OfficePlan {
  std::vector<double> x_m;
  std::vector<double> y_m;

  [[nodiscard]] Area outline() const {
    return {x_m.front() - margin(), y_m.front() - margin(), x_m.back() + margin(), y_m.back() + margin()};
  }
  [[nodiscard]] Area block(std::size_t i, std::size_t j) const {
    return Area{x_m[i], y_m[j], x_m[i + 1], y_m[j + 1]}.shrunk(0.5 * kCorridor_m);
  }
  [[nodiscard]] static double margin() { return 0.5 * kCorridor_m + kOuterRooms_m; }
};

OfficePlan draw_plan(const SceneOptions& options) {
  Rng rng = part_rng(options, WorldPart::kPlan);
  const auto columns = static_cast<int>(std::max(2L, std::lround(2.0 * options.scale)));
  const auto rows = static_cast<int>(std::max(1L, std::lround(options.scale)));
  OfficePlan plan{{0.0}, {0.0}};
  for (int i = 0; i < columns; ++i) plan.x_m.push_back(plan.x_m.back() + kCorridor_m + rng.uniform(9.0, 11.5));
  for (int j = 0; j < rows; ++j) plan.y_m.push_back(plan.y_m.back() + kCorridor_m + rng.uniform(7.0, 9.0));
  return plan;
}

// Four rooms, their doors to the corridors south and north.
void build_block(Storey& storey, const Area& block) {
  storey.corridor_wall({block.x1, block.y1}, {block.x0, block.y1}, kDoorSpacing_m);
  storey.corridor_wall({block.x0, block.y0}, {block.x1, block.y0}, kDoorSpacing_m);
  storey.plain_wall({block.x0, block.y0}, {block.x0, block.y1}, 0.15);
  storey.plain_wall({block.x1, block.y0}, {block.x1, block.y1}, 0.15);
  const Vector2d middle(0.5 * (block.x0 + block.x1), 0.5 * (block.y0 + block.y1));
  storey.plain_wall({block.x0, middle.y()}, {block.x1, middle.y()});
  storey.plain_wall({middle.x(), block.y0}, {middle.x(), block.y1});
  storey.furnish({block.x0, block.y0, middle.x(), middle.y()});
  storey.furnish({middle.x(), block.y0, block.x1, middle.y()});
  storey.furnish({block.x0, middle.y(), middle.x(), block.y1});
  storey.furnish({middle.x(), middle.y(), block.x1, block.y1});
}

// Rooms between the corridor's outer wall (start -> end, rooms on its left) and the outside.
void build_outer_rooms(Storey& storey, const Vector2d& start_m, const Vector2d& end_m) {
  const Vector2d along = (end_m - start_m).normalized();
  const Vector2d out = kOuterRooms_m * Vector2d(-along.y(), along.x());
  const double length_m = (end_m - start_m).norm();
  storey.corridor_wall(start_m, end_m, kDoorSpacing_m);
  storey.facade(start_m + out, end_m + out);
  const int rooms = std::max(1, static_cast<int>(std::lround(length_m / kDoorSpacing_m)));
  for (int i = 0; i <= rooms; ++i) {
    const Vector2d at_m = start_m + static_cast<double>(i) / rooms * length_m * along;
    storey.plain_wall(at_m, at_m + out);
    if (i == rooms) break;
    const Vector2d next_m = start_m + (i + 1.0) / rooms * length_m * along;
    const Vector2d low = at_m.cwiseMin(next_m).cwiseMin(at_m + out).cwiseMin(next_m + out);
    const Vector2d high = at_m.cwiseMax(next_m).cwiseMax(at_m + out).cwiseMax(next_m + out);
    storey.furnish({low.x(), low.y(), high.x(), high.y()});
  }
}

void build_storey(Storey& storey, const OfficePlan& plan) {
  storey.slabs(plan.outline());
  for (std::size_t i = 0; i + 1 < plan.x_m.size(); ++i) {
    for (std::size_t j = 0; j + 1 < plan.y_m.size(); ++j) build_block(storey, plan.block(i, j));
  }
  const double half = 0.5 * kCorridor_m;
  const Area ring{plan.x_m.front() - half, plan.y_m.front() - half, plan.x_m.back() + half, plan.y_m.back() + half};
  build_outer_rooms(storey, {ring.x1, ring.y0}, {ring.x0, ring.y0});
  build_outer_rooms(storey, {ring.x0, ring.y1}, {ring.x1, ring.y1});
  build_outer_rooms(storey, {ring.x0, ring.y0}, {ring.x0, ring.y1});
  build_outer_rooms(storey, {ring.x1, ring.y1}, {ring.x1, ring.y0});
  for (const double y : plan.y_m) storey.lamps({plan.x_m.front(), y}, {plan.x_m.back(), y});
  for (const double x : plan.x_m) storey.lamps({x, plan.y_m.front()}, {x, plan.y_m.back()});
}

// A ring of corridors from column i0 to i1 over rows 0 to j1; `clockwise` seen from above.
struct Ring {
  std::size_t i0, i1, j1;
  bool clockwise;
};

Vector3d ground(double x, double y) { return {x, y, 0.0}; }

// A door on the leg a -> b that is worth a visit; the earliest one past its middle.
std::optional<Door> door_beside(const std::vector<Door>& doors, const Vector3d& a, const Vector3d& b) {
  const Vector2d along = (b - a).head<2>().normalized();
  const double length_m = (b - a).norm();
  std::optional<Door> best;
  double best_m = length_m - 2.0;
  for (const Door& door : doors) {
    const Vector2d off = door.at_m - a.head<2>();
    const double at_m = off.dot(along);
    const double aside_m = std::abs(along.x() * off.y() - along.y() * off.x());
    if (aside_m > kCorridor_m || at_m < 0.4 * length_m || at_m > best_m) continue;
    best = door;
    best_m = at_m;
  }
  return best;
}

// Once round, and on to the middle of the second leg, which it knows by then; one room is visited on the way.
std::vector<Vector3d> ring_route(const OfficePlan& plan, const Ring& ring, const std::vector<Door>& doors, Rng& rng) {
  const double side = rng.uniform(-0.2, 0.2);
  const double x0 = plan.x_m[ring.i0] + side;
  const double x1 = plan.x_m[ring.i1] + side;
  const double y0 = plan.y_m.front() + side;
  const double y1 = plan.y_m[ring.j1] + side;
  std::vector<Vector3d> nodes = {ground(x0, y0), ground(x1, y0), ground(x1, y1), ground(x0, y1)};
  if (ring.clockwise) nodes = {ground(x1, y0), ground(x0, y0), ground(x0, y1), ground(x1, y1)};
  const Vector3d start = nodes[0] + 0.35 * (nodes[1] - nodes[0]);
  std::vector<Vector3d> route = {start, nodes[1], nodes[2]};
  if (const std::optional<Door> door = door_beside(doors, nodes[2], nodes[3])) {
    const Vector3d leg = (nodes[3] - nodes[2]).normalized();
    const Vector3d off = ground(door->at_m.x(), door->at_m.y()) - nodes[2];
    const Vector3d stop = nodes[2] + off.dot(leg) * leg;
    const Vector2d inside = door->at_m + 0.8 * door->into_room;
    route.insert(route.end(), {stop, ground(inside.x(), inside.y()), stop});
  }
  route.insert(route.end(), {nodes[3], nodes[0], nodes[1]});
  route.push_back(nodes[1] + std::min(1.0, 4.0 / (nodes[2] - nodes[1]).norm()) * (nodes[2] - nodes[1]));
  return route;
}

}  // namespace

Scene make_office(const SceneOptions& options) {
  const OfficePlan plan = draw_plan(options);
  Scene scene;
  Rng furniture = part_rng(options, WorldPart::kFurniture);
  Storey storey(scene.world.fixed, 0.0, kHeight_m, furniture);
  build_storey(storey, plan);

  Rng rng = part_rng(options, WorldPart::kRoutes);
  const std::size_t columns = plan.x_m.size() - 1;
  const std::size_t rows = plan.y_m.size() - 1;
  const std::size_t middle = columns / 2;  // the corridor where the halves' robots meet
  const Ring rings[] = {{0, middle, rows, false},
                        {middle, columns, rows, true},
                        {0, columns, rows, false},
                        {0, middle, rows, true},
                        {middle, columns, rows, false}};
  for (int r = 0; r < options.robots; ++r) {
    scene.routes.push_back({ring_route(plan, rings[r], storey.open_doors(), rng), {}, 0.0});
  }
  finish_routes(scene, options, {});
  scene.faults = {{.kind = FaultKind::kSlip, .robot = 0, .at = 0.75, .size_m = 0.35, .size_rad = 0.03}};
  if (options.robots >= 2) {
    scene.faults.push_back({.kind = FaultKind::kFrameOffset, .robot = 1, .size_m = 0.3, .size_rad = 0.01});
    scene.faults.push_back(
        {.kind = FaultKind::kMissedClosure, .robot = 1, .from = 0.25, .at = 0.7, .size_m = 0.8, .size_rad = 0.02});
  }
  return scene;
}

}  // namespace kilter
