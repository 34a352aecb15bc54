// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "kilter/base/rng.h"
#include "kilter/simulation/triangle_world.h"

namespace kilter {

/// A building drawn as the union of straight corridors in any direction; walls stand where the union ends.
class FloorPlan {
 public:
  /// Free floor along start -> end, `width_m` wide; it also reaches half its width beyond both ends, so that corridors
  /// that meet in a point join without a gap.
  void add_corridor(const Eigen::Vector2d& start_m, const Eigen::Vector2d& end_m, double width_m);

  /// Free floor exactly along start -> end.
  void add_passage(const Eigen::Vector2d& start_m, const Eigen::Vector2d& end_m, double width_m);

  /// Hedges instead of walls, `height_m` high, and behind them a tree now and then; no floor and no ceiling.
  void build_hedges(TriangleMesh& mesh, double height_m, Rng& rng) const;

  /// Walls, floor and ceiling, and by the walls the things that tell one place from another (door frames, pillars,
  /// cabinets, extinguishers), none within `clear_m` of the ways.
  void build(TriangleMesh& mesh, double height_m, const std::vector<std::vector<Eigen::Vector3d>>& ways, double clear_m,
             Rng& rng) const;

 private:
  // Part of a line, from its start.
  struct Span {
    double from_m, to_m;
  };
  struct Strip {
    Eigen::Vector2d start_m, along, left;
    double length_m, half_width_m;

    [[nodiscard]] bool contains(const Eigen::Vector2d& point_m) const;
    [[nodiscard]] std::optional<Span> span_inside(const Eigen::Vector2d& line_start_m,
                                                  const Eigen::Vector2d& line_along, double line_length_m,
                                                  bool with_walls) const;
  };
  // A piece of wall; the free side is to the left of start -> end.
  struct Piece {
    Eigen::Vector2d start_m, end_m;
  };

  [[nodiscard]] bool is_free(const Eigen::Vector2d& point_m) const;
  void walls_along(const Strip& strip, const Eigen::Vector2d& start_m, const Eigen::Vector2d& end_m,
                   std::vector<Piece>& pieces) const;
  [[nodiscard]] std::vector<Piece> walls() const;

  std::vector<Strip> strips_;
};

/// How near the closest of the ways comes to a point on the floor. [m]
[[nodiscard]] double distance_to_ways_m(const std::vector<std::vector<Eigen::Vector3d>>& ways,
                                        const Eigen::Vector2d& point_m);

}  // namespace kilter
