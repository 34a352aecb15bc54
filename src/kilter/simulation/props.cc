// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/simulation/props.h"

#include <cmath>
#include <numbers>

namespace kilter {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// A part of the wall: [from, to] along it, [bottom, top] above its floor.
void add_wall_part(TriangleMesh& mesh, const Wall& wall, double from_m, double to_m, double bottom_m, double top_m,
                   Material material) {
  if (to_m - from_m < 1e-3 || top_m - bottom_m < 1e-3) return;
  const Vector2d along = (wall.end_m - wall.start_m).normalized();
  const Vector2d middle = wall.start_m + 0.5 * (from_m + to_m) * along;
  mesh.add_box({.center_m = {middle.x(), middle.y(), wall.floor_z_m + 0.5 * (bottom_m + top_m)},
                .size_m = {to_m - from_m, wall.thickness_m, top_m - bottom_m},
                .yaw_rad = std::atan2(along.y(), along.x())},
               material);
}

// Adds a box given in the thing's own frame.
void add_part(TriangleMesh& mesh, const Pose3& T_world_thing, const Vector3d& center_m, const Vector3d& size_m,
              Material material) {
  TriangleMesh part;
  part.add_box({.center_m = center_m, .size_m = size_m}, material);
  mesh.append(part, T_world_thing);
}

// The silhouette of a car seen from its side, as (x, z) from front to back over the roof, extruded to its width.
void add_body(TriangleMesh& mesh, const std::vector<Vector2d>& outline, double width_m, Material material) {
  const double half_m = 0.5 * width_m;
  for (std::size_t i = 0; i + 1 < outline.size(); ++i) {
    const Vector2d& a = outline[i];
    const Vector2d& b = outline[i + 1];
    mesh.add_quad({a.x(), -half_m, a.y()}, {b.x(), -half_m, b.y()}, {b.x(), half_m, b.y()}, {a.x(), half_m, a.y()},
                  material);
    for (const double y : {-half_m, half_m}) {
      // The side under this piece of the outline, down to the sill.
      const double sill_m = outline.front().y();
      mesh.add_quad({a.x(), y, sill_m}, {b.x(), y, sill_m}, {b.x(), y, b.y()}, {a.x(), y, a.y()}, material);
    }
  }
}

void add_wheels(TriangleMesh& mesh, double wheelbase_m, double width_m) {
  for (const double x : {-0.5 * wheelbase_m, 0.5 * wheelbase_m}) {
    for (const double y : {-0.5 * width_m + 0.1, 0.5 * width_m - 0.1}) {
      mesh.add_box({.center_m = {x, y, 0.3}, .size_m = {0.55, 0.2, 0.6}}, Material::kFabric);
    }
  }
}

}  // namespace

Pose3 standing_at(const Vector3d& at, double yaw_rad) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ())), at};
}

void add_wall(TriangleMesh& mesh, const Wall& wall, Material material) {
  double done_m = 0.0;
  for (const Opening& opening : wall.openings) {
    add_wall_part(mesh, wall, done_m, opening.from_m, 0.0, wall.height_m, material);
    add_wall_part(mesh, wall, opening.from_m, opening.to_m, 0.0, opening.bottom_m, material);
    add_wall_part(mesh, wall, opening.from_m, opening.to_m, opening.top_m, wall.height_m, material);
    done_m = opening.to_m;
  }
  add_wall_part(mesh, wall, done_m, (wall.end_m - wall.start_m).norm(), 0.0, wall.height_m, material);
}

void add_desk(TriangleMesh& mesh, const Vector3d& at, double yaw_rad, Rng& rng) {
  const Pose3 T = standing_at(at, yaw_rad);
  const double width_m = rng.uniform(1.2, 1.8);
  add_part(mesh, T, {0.0, 0.0, 0.73}, {0.8, width_m, 0.04}, Material::kWood);
  for (const double y : {-0.5 * width_m + 0.05, 0.5 * width_m - 0.05}) {
    add_part(mesh, T, {0.0, y, 0.355}, {0.7, 0.05, 0.71}, Material::kWood);
  }
  const double screen_y = rng.uniform(-0.3, 0.3);
  add_part(mesh, T, {-0.2, screen_y, 1.0}, {0.05, 0.55, 0.35}, Material::kFabric);
}

void add_chair(TriangleMesh& mesh, const Vector3d& at, double yaw_rad) {
  const Pose3 T = standing_at(at, yaw_rad);
  add_part(mesh, T, {0.0, 0.0, 0.45}, {0.45, 0.45, 0.06}, Material::kFabric);
  add_part(mesh, T, {-0.22, 0.0, 0.75}, {0.05, 0.42, 0.5}, Material::kFabric);
  add_part(mesh, T, {0.0, 0.0, 0.22}, {0.06, 0.06, 0.44}, Material::kMetal);
  add_part(mesh, T, {0.0, 0.0, 0.04}, {0.5, 0.5, 0.06}, Material::kMetal);
}

void add_cabinet(TriangleMesh& mesh, const Vector3d& at, double yaw_rad, Rng& rng) {
  const double height_m = rng.uniform(0.8, 2.0);
  const double width_m = rng.uniform(0.6, 1.4);
  add_part(mesh, standing_at(at, yaw_rad), {0.0, 0.0, 0.5 * height_m}, {0.42, width_m, height_m}, Material::kWood);
}

void add_plant(TriangleMesh& mesh, const Vector3d& at, Rng& rng) {
  mesh.add_prism(at, 0.16, 0.2, 0.4, 10, Material::kPaint);
  const double height_m = rng.uniform(0.4, 0.9);
  mesh.add_leaves(at + Vector3d(0.0, 0.0, 0.4 + 0.5 * height_m), {0.18, 0.18, 0.5 * height_m}, 60, rng);
}

void add_tree(TriangleMesh& mesh, const Vector3d& at, double height_m, double crown_m, Rng& rng) {
  const double trunk_m = 0.02 * height_m + rng.uniform(0.05, 0.12);
  mesh.add_prism(at - Vector3d(0.0, 0.0, 0.3), trunk_m, 0.4 * trunk_m, height_m, 10, Material::kWood);
  for (int branch = 0; branch < 3; ++branch) {
    const double turn_rad = rng.uniform(0.0, 2.0 * std::numbers::pi);
    const Vector3d off(0.4 * crown_m * std::cos(turn_rad), 0.4 * crown_m * std::sin(turn_rad),
                       rng.uniform(0.62, 0.9) * height_m);
    mesh.add_leaves(at + off, {0.7 * crown_m, 0.7 * crown_m, 0.2 * height_m}, 160, rng);
  }
}

void add_lamp_post(TriangleMesh& mesh, const Vector3d& at, double height_m) {
  mesh.add_prism(at, 0.09, 0.06, height_m, 10, Material::kMetal);
  mesh.add_box({.center_m = at + Vector3d(0.5, 0.0, height_m), .size_m = {1.1, 0.25, 0.12}}, Material::kMetal);
  mesh.add_prism(at, 0.2, 0.2, 0.25, 10, Material::kConcrete);
}

TriangleMesh make_car(Rng& rng) {
  TriangleMesh car;
  const double length = rng.uniform(4.0, 4.8);
  const double roof = rng.uniform(1.4, 1.65);
  const double width = rng.uniform(1.7, 1.85);
  const double h = 0.5 * length;
  add_body(
      car,
      {{h, 0.3}, {h, 0.7}, {h - 1.1, 0.92}, {h - 1.8, roof}, {-h + 1.0, roof}, {-h + 0.3, 0.98}, {-h, 0.9}, {-h, 0.3}},
      width, Material::kPaint);
  add_wheels(car, length - 1.7, width);
  return car;
}

TriangleMesh make_van(Rng& rng) {
  TriangleMesh van;
  const double h = 0.5 * rng.uniform(5.6, 6.4);
  const double roof = rng.uniform(2.3, 2.7);
  add_body(van, {{h, 0.35}, {h, 0.9}, {h - 0.9, 1.15}, {h - 1.5, roof}, {-h, roof}, {-h, 0.35}}, 2.0, Material::kPaint);
  add_wheels(van, 3.6, 2.0);
  return van;
}

TriangleMesh make_person(Rng& rng) {
  TriangleMesh person;
  const double height_m = rng.uniform(1.55, 1.9);
  for (const double y : {-0.1, 0.1}) person.add_prism({0.0, y, 0.0}, 0.08, 0.1, 0.48 * height_m, 8, Material::kFabric);
  person.add_prism({0.0, 0.0, 0.48 * height_m}, 0.2, 0.24, 0.36 * height_m, 10, Material::kFabric);
  person.add_prism({0.0, 0.0, 0.85 * height_m}, 0.1, 0.09, 0.15 * height_m, 8, Material::kPlaster);
  return person;
}

}  // namespace kilter
