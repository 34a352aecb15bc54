// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/simulation/worlds/storey.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kilter {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kDoorWidth_m = 1.0;
constexpr double kWall_m = 0.15;

double heading_rad(const Vector2d& direction) { return std::atan2(direction.y(), direction.x()); }

Vector2d left_of(const Vector2d& direction) { return {-direction.y(), direction.x()}; }

}  // namespace

void Storey::slabs(const Area& area) {
  mesh_.add_floor(area.x0, area.y0, area.x1, area.y1, floor_z_m_, Material::kConcrete);
  mesh_.add_floor(area.x0, area.y0, area.x1, area.y1, floor_z_m_ + height_m_, Material::kPlaster);
}

void Storey::corridor_wall(const Vector2d& start_m, const Vector2d& end_m, double door_spacing_m) {
  const double length_m = (end_m - start_m).norm();
  const Vector2d along = (end_m - start_m).normalized();
  const Vector2d into_room = left_of(along);
  Wall wall{.start_m = start_m, .end_m = end_m, .floor_z_m = floor_z_m_, .height_m = height_m_, .thickness_m = kWall_m};
  const int doors = std::max(1, static_cast<int>(std::lround(length_m / door_spacing_m)));
  for (int i = 0; i < doors; ++i) {
    const double share = (i + 0.5 + rng_.uniform(-0.12, 0.12)) / doors;
    const double middle_m = share * length_m;
    const Vector2d at_m = start_m + middle_m * along;
    const bool open = rng_.uniform() < 0.5;
    wall.openings.push_back({middle_m - 0.5 * kDoorWidth_m, middle_m + 0.5 * kDoorWidth_m, 0.0, 2.05});
    door_leaf(at_m, along, open);
    if (open) open_doors_.push_back({at_m, into_room});
    const double beside_m = middle_m + (kDoorWidth_m + 0.4) * (rng_.uniform() < 0.5 ? -1.0 : 1.0);
    if (beside_m > 1.2 && beside_m < length_m - 1.2) corridor_things(start_m + beside_m * along, -into_room);
  }
  add_wall(mesh_, wall, Material::kPlaster);
}

// Leaf of a door in a wall along `along`; an open one stands inside the room.
void Storey::door_leaf(const Vector2d& at_m, const Vector2d& along, bool open) {
  const Vector2d into_room = left_of(along);
  const Vector2d hinge = at_m - 0.5 * kDoorWidth_m * along;
  const Vector2d middle = open ? Vector2d(hinge + 0.5 * kDoorWidth_m * into_room) : Vector2d(at_m + 0.04 * into_room);
  mesh_.add_box({.center_m = on_floor(middle) + Vector3d(0.0, 0.0, 1.0),
                 .size_m = {kDoorWidth_m, 0.04, 2.0},
                 .yaw_rad = heading_rad(open ? into_room : along)},
                Material::kWood);
}

// Something by a corridor's wall, never wider than half a metre.
void Storey::corridor_things(const Vector2d& at_m, const Vector2d& into_corridor) {
  const double yaw_rad = heading_rad(into_corridor);
  const double face_m = 0.5 * kWall_m;
  const double draw = rng_.uniform();
  if (draw < 0.3) {
    add_cabinet(mesh_, on_floor(at_m + (face_m + 0.21) * into_corridor), yaw_rad, rng_);
  } else if (draw < 0.5) {
    mesh_.add_box({.center_m = on_floor(at_m + (face_m + 0.1) * into_corridor) + Vector3d(0.0, 0.0, 0.5 * height_m_),
                   .size_m = {0.2, rng_.uniform(0.3, 0.6), height_m_},
                   .yaw_rad = yaw_rad},
                  Material::kConcrete);
  } else if (draw < 0.7) {
    mesh_.add_prism(on_floor(at_m + (face_m + 0.1) * into_corridor) + Vector3d(0.0, 0.0, 0.7), 0.08, 0.06, 0.5, 8,
                    Material::kPaint);
  } else if (draw < 0.85) {
    add_plant(mesh_, on_floor(at_m + (face_m + 0.25) * into_corridor), rng_);
  } else {
    add_chair(mesh_, on_floor(at_m + (face_m + 0.3) * into_corridor), yaw_rad);
  }
}

void Storey::plain_wall(const Vector2d& start_m, const Vector2d& end_m, double thickness_m) {
  add_wall(
      mesh_,
      {.start_m = start_m, .end_m = end_m, .floor_z_m = floor_z_m_, .height_m = height_m_, .thickness_m = thickness_m},
      Material::kPlaster);
}

void Storey::facade(const Vector2d& start_m, const Vector2d& end_m) {
  const double length_m = (end_m - start_m).norm();
  Wall wall{.start_m = start_m, .end_m = end_m, .floor_z_m = floor_z_m_, .height_m = height_m_, .thickness_m = 0.3};
  const int windows = static_cast<int>(length_m / 2.4);
  for (int i = 0; i < windows; ++i) {
    const double middle_m = (i + 0.5) * length_m / windows;
    wall.openings.push_back({middle_m - 0.7, middle_m + 0.7, 0.9, 2.1});
  }
  add_wall(mesh_, wall, Material::kConcrete);
}

bool Storey::near_door(const Vector2d& at_m) const {
  constexpr double kClear_m = 2.5;
  return std::any_of(open_doors_.begin(), open_doors_.end(),
                     [&](const Door& door) { return (door.at_m - at_m).norm() < kClear_m; });
}

void Storey::furnish(const Area& room) {
  const Area inside = room.shrunk(0.9);
  const double area_m2 = (room.x1 - room.x0) * (room.y1 - room.y0);
  const int desks = std::max(1, static_cast<int>(area_m2 / 10.0));
  for (int i = 0; i < desks; ++i) {
    const double x = rng_.uniform(inside.x0, inside.x1);
    const double y = rng_.uniform(inside.y0, inside.y1);
    const double yaw_rad = 0.5 * std::numbers::pi * static_cast<double>(rng_.below(4));
    const double turned_rad = yaw_rad + std::numbers::pi + rng_.uniform(-0.6, 0.6);
    if (near_door({x, y})) continue;
    add_desk(mesh_, on_floor({x, y}), yaw_rad, rng_);
    add_chair(mesh_, on_floor({x + 0.75 * std::cos(yaw_rad), y + 0.75 * std::sin(yaw_rad)}), turned_rad);
  }
  const double low_y = rng_.uniform(inside.y0, inside.y1);
  const double high_y = rng_.uniform(inside.y0, inside.y1);
  if (!near_door({room.x0, low_y})) add_cabinet(mesh_, on_floor({room.x0 + 0.35, low_y}), 0.0, rng_);
  if (!near_door({room.x1, high_y})) add_cabinet(mesh_, on_floor({room.x1 - 0.35, high_y}), std::numbers::pi, rng_);
  if (!near_door({inside.x1, inside.y1})) add_plant(mesh_, on_floor({inside.x1, inside.y1}), rng_);
}

void Storey::lamps(const Vector2d& start_m, const Vector2d& end_m) {
  const double length_m = (end_m - start_m).norm();
  const Vector2d along = (end_m - start_m).normalized();
  const int count = std::max(1, static_cast<int>(length_m / 3.0));
  for (int i = 0; i < count; ++i) {
    const Vector2d at_m = start_m + (i + 0.5) / count * length_m * along;
    mesh_.add_box({.center_m = on_floor(at_m) + Vector3d(0.0, 0.0, height_m_ - 0.05),
                   .size_m = {1.2, 0.2, 0.1},
                   .yaw_rad = heading_rad(along)},
                  Material::kPaint);
  }
}

}  // namespace kilter
