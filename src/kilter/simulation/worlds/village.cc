// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Two blocks of houses with gardens round a common street on a gentle slope: gabled roofs, hedges, fences and low
// walls, parked cars, trees; one robot drives round each block.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "kilter/simulation/props.h"
#include "kilter/simulation/worlds/worlds.h"

namespace kilter {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;
constexpr double kHalfRoad_m = 3.6;
constexpr double kBlock_m = 22.0;    // from the middle of one street to that of the next
constexpr double kLot_m = 11.0;      // of a house, along its street
constexpr double kSetback_m = 8.0;   // from the middle of the street to that of a house
constexpr double kCrossing_m = 7.0;  // kept free of parked cars

double ground_m(double x, double y) {
  return 0.7 * std::sin(0.045 * x + 0.2) + 0.5 * std::sin(0.055 * y + 1.0) + 0.04 * std::sin(0.6 * x + 0.5 * y);
}

Vector3d on_ground(const Vector2d& at) { return {at.x(), at.y(), ground_m(at.x(), at.y())}; }

// A straight street between two crossings. Houses stand on the sides whose sign is in `sides` (left is +1).
struct Street {
  Vector2d from_m, to_m;
  std::vector<double> sides;

  [[nodiscard]] double length_m() const { return (to_m - from_m).norm(); }
  [[nodiscard]] Vector2d along() const { return (to_m - from_m).normalized(); }
  [[nodiscard]] Vector2d left() const { return {-along().y(), along().x()}; }
  [[nodiscard]] Vector2d at(double path_m, double aside_m) const {
    return from_m + path_m * along() + aside_m * left();
  }
  [[nodiscard]] double yaw_rad() const { return std::atan2(along().y(), along().x()); }
};

struct VillagePlan {
  double half_length_m = 22.0;

  [[nodiscard]] std::vector<Street> streets() const {
    const double x = half_length_m;
    return {{{-x, 0.0}, {x, 0.0}, {-1.0, 1.0}},        {{-x, kBlock_m}, {x, kBlock_m}, {1.0}},
            {{-x, -kBlock_m}, {x, -kBlock_m}, {-1.0}}, {{-x, -kBlock_m}, {-x, 0.0}, {1.0}},
            {{-x, 0.0}, {-x, kBlock_m}, {1.0}},        {{x, -kBlock_m}, {x, 0.0}, {-1.0}},
            {{x, 0.0}, {x, kBlock_m}, {-1.0}}};
  }
};

// Four walls with windows and a door to the street, a gabled roof along the street, a chimney.
void add_house(TriangleMesh& mesh, const Vector2d& at, double yaw_rad, double width_m, double depth_m, Rng& rng) {
  const double base_m = ground_m(at.x(), at.y()) - 0.5;
  const double eaves_m = 0.5 + (rng.uniform() < 0.5 ? 2.9 : 5.4) + rng.uniform(-0.2, 0.2);
  const Eigen::Rotation2Dd turn(yaw_rad);
  const auto corner = [&](double x, double y) { return Vector2d(at + turn * Vector2d(x, y)); };
  const double w = 0.5 * width_m;
  const double d = 0.5 * depth_m;
  const Vector2d corners[] = {corner(-w, -d), corner(w, -d), corner(w, d), corner(-w, d)};
  const Material walls = rng.uniform() < 0.5 ? Material::kPlaster : Material::kConcrete;
  for (int i = 0; i < 4; ++i) {
    Wall wall{.start_m = corners[i],
              .end_m = corners[(i + 1) % 4],
              .floor_z_m = base_m,
              .height_m = eaves_m,
              .thickness_m = 0.3};
    const double length_m = (wall.end_m - wall.start_m).norm();
    double x = rng.uniform(0.7, 1.3);
    if (i == 0) {
      wall.openings.push_back({x, x + 1.0, 0.55, 2.6});
      x += 1.0 + rng.uniform(0.8, 1.4);
    }
    for (; x + 1.8 < length_m; x += 1.1 + rng.uniform(0.9, 1.8)) wall.openings.push_back({x, x + 1.1, 1.4, 2.7});
    add_wall(mesh, wall, walls);
  }
  const Pose3 T = standing_at({at.x(), at.y(), base_m}, yaw_rad);
  TriangleMesh house;
  // Curtains, which are what is seen through the windows.
  house.add_box({.center_m = {0.0, 0.0, 0.5 * eaves_m}, .size_m = {width_m - 1.0, depth_m - 1.0, eaves_m}},
                Material::kFabric);
  const double ridge_m = eaves_m + d * rng.uniform(0.6, 1.0);
  const double over_m = 0.4;  // beyond the walls
  const double drop_m = (ridge_m - eaves_m) * over_m / d;
  for (const double side : {-1.0, 1.0}) {
    const double y = side * (d + over_m);
    house.add_quad({-w - over_m, y, eaves_m - drop_m}, {w + over_m, y, eaves_m - drop_m}, {w + over_m, 0.0, ridge_m},
                   {-w - over_m, 0.0, ridge_m}, Material::kConcrete);
    house.add_triangle({side * w, -d, eaves_m}, {side * w, d, eaves_m}, {side * w, 0.0, ridge_m}, walls);
  }
  house.add_box({.center_m = {rng.uniform(-0.6, 0.6) * w, 0.4, ridge_m}, .size_m = {0.6, 0.6, 1.6}},
                Material::kConcrete);
  mesh.append(house, T);
}

// What stands between garden and pavement, in pieces that follow the ground: a hedge, pickets, a low wall, nothing.
void add_border(TriangleMesh& mesh, const Vector2d& from_m, const Vector2d& to_m, Rng& rng) {
  const double kind = rng.uniform();
  if (kind > 0.85) return;
  const double yaw_rad = std::atan2((to_m - from_m).y(), (to_m - from_m).x());
  const double length_m = (to_m - from_m).norm();
  const double height_m = kind < 0.35 ? rng.uniform(0.9, 1.6) : kind < 0.6 ? rng.uniform(0.9, 1.2) : 0.7;
  const double gate_m = rng.uniform(0.2, 0.7) * length_m;
  constexpr double kPiece_m = 0.8;
  for (double s = 0.0; s + kPiece_m <= length_m; s += kPiece_m) {
    if (std::abs(s - gate_m) < 1.0) continue;
    const Vector3d at = on_ground(from_m + (s + 0.5 * kPiece_m) / length_m * (to_m - from_m));
    const Vector3d middle = at + Vector3d(0.0, 0.0, 0.5 * height_m);
    if (kind < 0.35) {
      mesh.add_box({.center_m = middle, .size_m = {kPiece_m, 0.45, height_m}, .yaw_rad = yaw_rad}, Material::kFoliage);
      mesh.add_leaves(middle, {0.5, 0.5, 0.5 * height_m}, 25, rng);
    } else if (kind < 0.6) {
      const Vector2d step = 0.16 * (to_m - from_m) / length_m;
      for (int i = -2; i <= 2; ++i) {
        mesh.add_box({.center_m = middle + Vector3d(i * step.x(), i * step.y(), 0.0),
                      .size_m = {0.09, 0.03, height_m},
                      .yaw_rad = yaw_rad},
                     Material::kWood);
      }
    } else {
      mesh.add_box({.center_m = at, .size_m = {kPiece_m, 0.25, 2.0 * height_m}, .yaw_rad = yaw_rad},
                   Material::kConcrete);
    }
  }
}

void build_lot(TriangleMesh& mesh, const Street& street, double middle_m, double side, Rng& rng) {
  const double yaw_rad = street.yaw_rad() + (side < 0.0 ? kPi : 0.0) + rng.uniform(-0.08, 0.08);
  const double depth_m = rng.uniform(5.0, 6.4);
  const double setback_m = side * (kSetback_m + rng.uniform(-0.4, 0.4));
  add_house(mesh, street.at(middle_m + rng.uniform(-0.7, 0.7), setback_m), yaw_rad, rng.uniform(6.5, 8.5), depth_m,
            rng);
  const double edge_m = side * (kHalfRoad_m + 0.6);
  add_border(mesh, street.at(middle_m - 0.5 * kLot_m + 0.4, edge_m), street.at(middle_m + 0.5 * kLot_m - 0.4, edge_m),
             rng);
  const Vector2d between = street.at(middle_m + 0.5 * kLot_m, side * (kHalfRoad_m + rng.uniform(1.5, 5.0)));
  if (rng.uniform() < 0.5) {
    add_tree(mesh, on_ground(between), rng.uniform(3.5, 7.0), rng.uniform(0.9, 1.6), rng);
  } else if (rng.uniform() < 0.5) {  // a shed
    const double height_m = rng.uniform(1.9, 2.4);
    mesh.add_box({.center_m = on_ground(between) + Vector3d(0.0, 0.0, 0.5 * height_m - 0.2),
                  .size_m = {1.8, 2.2, height_m + 0.4},
                  .yaw_rad = yaw_rad},
                 Material::kWood);
  }
}

void build_street(TriangleMesh& mesh, const Street& street, Rng& rng) {
  const double free_m = street.length_m() - 2.0 * kHalfRoad_m;
  const int lots = static_cast<int>(free_m / kLot_m);
  for (const double side : street.sides) {
    for (int i = 0; i < lots; ++i) {
      if (rng.uniform() < 0.08) continue;
      build_lot(mesh, street, kHalfRoad_m + (i + 0.5) * free_m / lots, side, rng);
    }
  }
  for (const double side : {-1.0, 1.0}) {
    for (double s = kCrossing_m; s < street.length_m() - kCrossing_m; s += 6.0) {
      if (rng.uniform() > 0.3) continue;
      const Vector2d at = street.at(s + rng.uniform(-0.5, 0.5), side * (kHalfRoad_m - 0.9));
      const double yaw_rad = street.yaw_rad() + (side < 0.0 ? 0.0 : kPi) + rng.uniform(-0.04, 0.04);
      mesh.append(rng.uniform() < 0.1 ? make_van(rng) : make_car(rng), standing_at(on_ground(at), yaw_rad));
    }
  }
  for (double s = kCrossing_m + rng.uniform(0.0, 4.0); s < street.length_m() - kCrossing_m; s += 15.0) {
    add_lamp_post(mesh, on_ground(street.at(s, kHalfRoad_m + 0.3)), 5.5);
  }
}

// Through corners on the ground, with points in between so that the way follows it.
std::vector<Vector3d> along_ground(const std::vector<Vector2d>& corners) {
  std::vector<Vector3d> way;
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    const Vector2d leg = corners[i + 1] - corners[i];
    const int parts = std::max(1, static_cast<int>(leg.norm() / 3.0));
    for (int k = 0; k < parts; ++k) way.push_back(on_ground(corners[i] + static_cast<double>(k) / parts * leg));
  }
  way.push_back(on_ground(corners.back()));
  return way;
}

// On the right, round the blocks from y0 to y1, and on along the first street, which it knows by then.
std::vector<Vector3d> block_route(const VillagePlan& plan, double y0, double y1, bool clockwise, Rng& rng) {
  const double aside = (clockwise ? -1.0 : 1.0) * (0.8 + rng.uniform(-0.2, 0.2));
  const double x = plan.half_length_m + aside;
  const double low = y0 - aside;
  const double high = y1 + aside;
  std::vector<Vector2d> nodes = {{-x, low}, {x, low}, {x, high}, {-x, high}};
  if (clockwise) nodes = {{x, high}, {x, low}, {-x, low}, {-x, high}};
  const Vector2d start = nodes[0] + 0.3 * (nodes[1] - nodes[0]);
  return along_ground(
      {start, nodes[1], nodes[2], nodes[3], nodes[0], nodes[1], nodes[1] + 0.4 * (nodes[2] - nodes[1])});
}

void add_traffic(TriangleWorld& world, const VillagePlan& plan, Rng& rng) {
  for (const double y : {0.0, -kBlock_m}) {
    const double x = plan.half_length_m - 1.2;
    const auto corner = [&](double cx, double cy) { return on_ground({cx, cy}); };
    MovingObject car{make_car(rng), {}, rng.uniform(3.0, 6.0), rng.uniform(0.0, 80.0)};
    car.circuit_m = {corner(-x, y + 1.2), corner(-x, y + kBlock_m - 1.2), corner(x, y + kBlock_m - 1.2),
                     corner(x, y + 1.2)};
    world.moving.push_back(car);
    MovingObject walker{make_person(rng), {}, rng.uniform(1.0, 1.5), rng.uniform(0.0, 30.0)};
    const double pavement = y + kHalfRoad_m + 0.1;
    walker.circuit_m = {corner(-0.7 * x, pavement), corner(rng.uniform(0.2, 0.8) * x, pavement)};
    world.moving.push_back(walker);
  }
}

}  // namespace

Scene make_village(const SceneOptions& options) {
  const VillagePlan plan{22.0 * options.scale};
  Scene scene;
  const double reach_x = plan.half_length_m + 45.0;
  const double reach_y = kBlock_m + 45.0;
  scene.world.fixed.add_terrain(-reach_x, -reach_y, reach_x, reach_y, 1.5, ground_m, Material::kAsphalt);
  Rng street = part_rng(options, WorldPart::kStreet);
  for (const Street& one : plan.streets()) build_street(scene.world.fixed, one, street);
  Rng traffic = part_rng(options, WorldPart::kTraffic);
  add_traffic(scene.world, plan, traffic);

  Rng rng = part_rng(options, WorldPart::kRoutes);
  const std::vector<std::vector<Vector3d>> ways = {
      block_route(plan, 0.0, kBlock_m, false, rng), block_route(plan, -kBlock_m, 0.0, true, rng),
      block_route(plan, -kBlock_m, kBlock_m, false, rng), block_route(plan, 0.0, kBlock_m, true, rng),
      block_route(plan, -kBlock_m, 0.0, false, rng)};
  for (int r = 0; r < options.robots; ++r) scene.routes.push_back({ways[static_cast<std::size_t>(r)], {}, 0.0});
  finish_routes(scene, options, {.speed_mps = 1.5, .corner_radius_m = 2.0, .sensor_height_m = 1.2, .sway_rad = 0.008});
  scene.scan_step_m = 1.0;
  scene.slam.closure_distance_m = 3.0;
  scene.slam.closure_spacing_m = 4.0;
  scene.faults = {{.kind = FaultKind::kSlip, .robot = 0, .at = 0.35, .size_m = 0.3, .size_rad = 0.02}};
  if (options.robots >= 2) {
    scene.faults.push_back({.kind = FaultKind::kFrameDrift, .robot = 1, .from = 0.2, .size_m = 0.35, .size_rad = 0.01});
  }
  return scene;
}

}  // namespace kilter
