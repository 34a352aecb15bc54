// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/simulation/worlds/door.h"

#include <cmath>

namespace kilter {
namespace {

constexpr double kForEver_s = 1e9;

MovingObject closed_door(const DoorPlace& place, double height_m) {
  MovingObject door;
  door.mesh.add_box({.center_m = {place.at_m.x(), place.at_m.y(), 0.5 * height_m},
                     .size_m = {0.05, place.width_m, height_m},
                     .yaw_rad = std::atan2(place.along.y(), place.along.x())},
                    Material::kWood);
  return door;
}

// When a door is open: while a robot is near, and for ever after or before that as its habit says.
std::vector<TimeSpan> open_times(const DoorPlace& place, const Scene& scene) {
  constexpr double kStep_s = 0.05;
  std::vector<TimeSpan> open;
  for (const RobotRoute& route : scene.routes) {
    const Trajectory drive = Trajectory::along(route.corners_m, route.drive);
    for (double t = 0.0; t < drive.duration_s(); t += kStep_s) {
      if ((drive.at(t).translation_m().head<2>() - place.at_m).norm() > place.opens_at_m) continue;
      const double now_s = route.start_s + t;
      if (open.empty() || open.back().to_s < now_s - 2.0 * kStep_s) open.push_back({now_s, now_s});
      open.back().to_s = now_s;
    }
  }
  if (place.habit == DoorHabit::kOpensForGood && !open.empty()) open.front().to_s = kForEver_s;
  if (place.habit == DoorHabit::kClosesAtLast && !open.empty()) open.front().from_s = -kForEver_s;
  return open;
}

}  // namespace

void hang_doors(const std::vector<DoorPlace>& places, double height_m, Scene& scene) {
  for (const DoorPlace& place : places) {
    MovingObject door = closed_door(place, height_m);
    door.absent = open_times(place, scene);
    scene.world.moving.push_back(std::move(door));
  }
}

}  // namespace kilter
