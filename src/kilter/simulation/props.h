// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "kilter/base/rng.h"
#include "kilter/simulation/triangle_world.h"

namespace kilter {

/// A gap in a wall, measured along it from its start: a door (bottom 0) or a window.
struct Opening {
  double from_m = 0.0;
  double to_m = 1.0;
  double bottom_m = 0.0;
  double top_m = 2.05;
};

/// A straight wall from `start_m` to `end_m` (x, y; centre line) standing at height `floor_z_m`.
struct Wall {
  Eigen::Vector2d start_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d end_m = Eigen::Vector2d::UnitX();
  double floor_z_m = 0.0;
  double height_m = 2.7;
  double thickness_m = 0.15;
  std::vector<Opening> openings = {};  ///< sorted, apart from each other
};

void add_wall(TriangleMesh& mesh, const Wall& wall, Material material);

/// Furniture and street things, standing on `at` and turned by `yaw_rad`; x is their front where they have one.
void add_desk(TriangleMesh& mesh, const Eigen::Vector3d& at, double yaw_rad, Rng& rng);
void add_chair(TriangleMesh& mesh, const Eigen::Vector3d& at, double yaw_rad);
void add_cabinet(TriangleMesh& mesh, const Eigen::Vector3d& at, double yaw_rad, Rng& rng);
void add_plant(TriangleMesh& mesh, const Eigen::Vector3d& at, Rng& rng);
void add_tree(TriangleMesh& mesh, const Eigen::Vector3d& at, double height_m, double crown_m, Rng& rng);
void add_lamp_post(TriangleMesh& mesh, const Eigen::Vector3d& at, double height_m);

/// A car about 4.4 m long; every one differs a little.
[[nodiscard]] TriangleMesh make_car(Rng& rng);

/// A van about 6 m long and 2.5 m high, which hides what is behind it.
[[nodiscard]] TriangleMesh make_van(Rng& rng);

/// A standing person.
[[nodiscard]] TriangleMesh make_person(Rng& rng);

/// T_world_thing for something that stands on `at`.
[[nodiscard]] Pose3 standing_at(const Eigen::Vector3d& at, double yaw_rad);

}  // namespace kilter
