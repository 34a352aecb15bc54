// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "kilter/simulation/props.h"

namespace kilter {

/// A rectangle on the floor.
struct Area {
  double x0 = 0.0, y0 = 0.0, x1 = 1.0, y1 = 1.0;

  [[nodiscard]] Area shrunk(double by_m) const { return {x0 + by_m, y0 + by_m, x1 - by_m, y1 - by_m}; }
};

/// An open door that a robot may pass.
struct Door {
  Eigen::Vector2d at_m;       ///< middle of the door
  Eigen::Vector2d into_room;  ///< unit
};

/// Builds one storey of a building into a mesh: walls with doors, and what stands in rooms and corridors.
class Storey {
 public:
  Storey(TriangleMesh& mesh, double floor_z_m, double height_m, Rng& rng)
      : mesh_(mesh), floor_z_m_(floor_z_m), height_m_(height_m), rng_(rng) {}

  /// Floor and ceiling.
  void slabs(const Area& area);

  /// A wall between corridor and rooms with a door about every `door_spacing_m`, open or closed, and with the things
  /// that hang and stand along corridors. Rooms lie to the left of start -> end.
  void corridor_wall(const Eigen::Vector2d& start_m, const Eigen::Vector2d& end_m, double door_spacing_m);

  /// A wall without doors.
  void plain_wall(const Eigen::Vector2d& start_m, const Eigen::Vector2d& end_m, double thickness_m = 0.12);

  /// A wall to the outside, with windows.
  void facade(const Eigen::Vector2d& start_m, const Eigen::Vector2d& end_m);

  /// Desks, chairs, cabinets and plants inside a room, away from the open doors built so far.
  void furnish(const Area& room);

  /// Lamps under the ceiling along a corridor.
  void lamps(const Eigen::Vector2d& start_m, const Eigen::Vector2d& end_m);

  [[nodiscard]] const std::vector<Door>& open_doors() const { return open_doors_; }

 private:
  void door_leaf(const Eigen::Vector2d& at_m, const Eigen::Vector2d& along, bool open);
  [[nodiscard]] bool near_door(const Eigen::Vector2d& at_m) const;
  void corridor_things(const Eigen::Vector2d& at_m, const Eigen::Vector2d& into_corridor);
  [[nodiscard]] Eigen::Vector3d on_floor(const Eigen::Vector2d& at_m) const { return {at_m.x(), at_m.y(), floor_z_m_}; }

  TriangleMesh& mesh_;
  double floor_z_m_;
  double height_m_;
  Rng& rng_;
  std::vector<Door> open_doors_;
};

}  // namespace kilter
