// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/simulation/worlds/floor_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kilter/simulation/props.h"

namespace kilter {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// How far walls that meet reach into each other.
constexpr double kReach_m = 1e-4;

Vector2d left_of(const Vector2d& along) { return {-along.y(), along.x()}; }

// One thing against the wall at `at_m`; `out` points from the wall into the corridor.
void add_thing(TriangleMesh& mesh, const Vector2d& at_m, const Vector2d& out, double height_m, Rng& rng) {
  const double yaw_rad = std::atan2(out.y(), out.x());
  const auto at = [&](double off_m, double z) {
    const Vector2d p = at_m + off_m * out;
    return Vector3d(p.x(), p.y(), z);
  };
  const double draw = rng.uniform();
  if (draw < 0.35) {
    mesh.add_box(
        {.center_m = at(0.1, 0.5 * height_m), .size_m = {0.2, rng.uniform(0.3, 0.6), height_m}, .yaw_rad = yaw_rad},
        Material::kConcrete);
  } else if (draw < 0.6) {
    mesh.add_box({.center_m = at(0.03, 1.05), .size_m = {0.06, 1.0, 2.1}, .yaw_rad = yaw_rad}, Material::kWood);
  } else if (draw < 0.8) {
    add_cabinet(mesh, at(0.21, 0.0), yaw_rad, rng);
  } else {
    mesh.add_prism(at(0.12, 0.6), 0.09, 0.07, 0.6, 8, Material::kPaint);
  }
}

}  // namespace

bool FloorPlan::Strip::contains(const Vector2d& point_m) const {
  const Vector2d off = point_m - start_m;
  const double s = off.dot(along);
  return s > 0.0 && s < length_m && std::abs(off.dot(left)) < half_width_m;
}

// Which part of start + s * along, s from 0 to length, runs inside the strip. Where walls meet, a tenth of a millimetre
// of the strip does not count, so that they overlap and nobody looks between them. A line that runs along the strip's
// own wall is inside if `with_walls`.
std::optional<FloorPlan::Span> FloorPlan::Strip::span_inside(const Vector2d& line_start_m, const Vector2d& line_along,
                                                             double line_length_m, bool with_walls) const {
  const Vector2d off = line_start_m - start_m;
  Span span{0.0, line_length_m};
  const auto clip = [&](double at_m, double slope, double low_m, double high_m) {
    if (std::abs(slope) < 1e-9) {
      const double margin_m = with_walls ? -kReach_m : kReach_m;
      if (at_m < low_m + margin_m || at_m > high_m - margin_m) span.to_m = span.from_m;
      return;
    }
    const auto [near_m, far_m] = std::minmax({(low_m + kReach_m - at_m) / slope, (high_m - kReach_m - at_m) / slope});
    span = {std::max(span.from_m, near_m), std::min(span.to_m, far_m)};
  };
  clip(off.dot(along), line_along.dot(along), 0.0, length_m);
  clip(off.dot(left), line_along.dot(left), -half_width_m, half_width_m);
  if (span.to_m <= span.from_m) return std::nullopt;
  return span;
}

void FloorPlan::add_passage(const Vector2d& start_m, const Vector2d& end_m, double width_m) {
  const Vector2d along = (end_m - start_m).normalized();
  strips_.push_back({start_m, along, left_of(along), (end_m - start_m).norm(), 0.5 * width_m});
}

void FloorPlan::add_corridor(const Vector2d& start_m, const Vector2d& end_m, double width_m) {
  const Vector2d reach = 0.5 * width_m * (end_m - start_m).normalized();
  add_passage(start_m - reach, end_m + reach, width_m);
}

bool FloorPlan::is_free(const Vector2d& point_m) const {
  return std::any_of(strips_.begin(), strips_.end(), [&](const Strip& strip) { return strip.contains(point_m); });
}

// The parts of one side of a strip that no other strip opens; of two that share a wall, the first has it.
void FloorPlan::walls_along(const Strip& strip, const Vector2d& start_m, const Vector2d& end_m,
                            std::vector<Piece>& pieces) const {
  const double length_m = (end_m - start_m).norm();
  const Vector2d along = (end_m - start_m) / length_m;
  std::vector<Span> open;
  for (const Strip& other : strips_) {
    if (&other == &strip) continue;
    if (const auto span = other.span_inside(start_m, along, length_m, &other < &strip)) open.push_back(*span);
  }
  std::sort(open.begin(), open.end(), [](const Span& a, const Span& b) { return a.from_m < b.from_m; });
  open.push_back({length_m, length_m});
  double wall_from_m = 0.0;
  for (const Span& span : open) {
    if (span.from_m > wall_from_m + 2.0 * kReach_m) {
      pieces.push_back({start_m + wall_from_m * along, start_m + span.from_m * along});
    }
    wall_from_m = std::max(wall_from_m, span.to_m);
  }
}

std::vector<FloorPlan::Piece> FloorPlan::walls() const {
  std::vector<Piece> pieces;
  for (const Strip& strip : strips_) {
    const Vector2d side = strip.half_width_m * strip.left;
    const Vector2d far_m = strip.start_m + strip.length_m * strip.along;
    // Counter-clockwise round the strip, so that the free side is on the left.
    const Vector2d corners[] = {strip.start_m - side, far_m - side, far_m + side, strip.start_m + side};
    for (int i = 0; i < 4; ++i) walls_along(strip, corners[i], corners[(i + 1) % 4], pieces);
  }
  return pieces;
}

void FloorPlan::build_hedges(TriangleMesh& mesh, double height_m, Rng& rng) const {
  constexpr double kSegment_m = 1.5;
  constexpr double kDepth_m = 0.5;
  constexpr double kSetback_m = 0.25;
  // Neighbours overlap although they stand differently deep, and so do two hedges in a corner: nobody looks between.
  constexpr double kJoint_m = 0.05;
  constexpr double kCorner_m = kSetback_m + 0.1;
  for (const Piece& piece : walls()) {
    const Vector2d along = (piece.end_m - piece.start_m).normalized();
    const Vector2d away = -left_of(along);
    const double length_m = (piece.end_m - piece.start_m).norm();
    const int segments = std::max(1, static_cast<int>(length_m / kSegment_m));
    const auto reach_m = [&](const Vector2d& end_m, const Vector2d& out) {
      return is_free(end_m + kCorner_m * out) ? kJoint_m : kCorner_m;
    };
    const double reach_start_m = reach_m(piece.start_m, -along);
    const double reach_end_m = reach_m(piece.end_m, along);
    for (int i = 0; i < segments; ++i) {
      const double top_m = height_m * rng.uniform(0.92, 1.08);
      const double setback_m = 0.5 * kDepth_m + rng.uniform(0.0, kSetback_m);
      const Vector2d at_m = piece.start_m + (i + 0.5) / segments * length_m * along + setback_m * away;
      const double before_m = i == 0 ? reach_start_m : kJoint_m;
      const double after_m = i + 1 == segments ? reach_end_m : kJoint_m;
      const Vector2d middle_m = at_m + 0.5 * (after_m - before_m) * along;
      mesh.add_box({.center_m = {middle_m.x(), middle_m.y(), 0.5 * top_m},
                    .size_m = {length_m / segments + before_m + after_m, kDepth_m, top_m + 0.6},
                    .yaw_rad = std::atan2(along.y(), along.x())},
                   Material::kFoliage);
      const Vector2d tree_m = at_m + rng.uniform(0.8, 1.2) * away;
      if (rng.uniform() < 0.12 && !is_free(tree_m)) {
        add_tree(mesh, {tree_m.x(), tree_m.y(), 0.0}, rng.uniform(4.5, 7.0), rng.uniform(0.7, 1.1), rng);
      }
    }
  }
}

void FloorPlan::build(TriangleMesh& mesh, double height_m, const std::vector<std::vector<Vector3d>>& ways,
                      double clear_m, Rng& rng) const {
  Vector2d low = strips_.front().start_m;
  Vector2d high = low;
  for (const Piece& piece : walls()) {
    low = low.cwiseMin(piece.start_m).cwiseMin(piece.end_m);
    high = high.cwiseMax(piece.start_m).cwiseMax(piece.end_m);
    mesh.add_quad({piece.start_m.x(), piece.start_m.y(), 0.0}, {piece.end_m.x(), piece.end_m.y(), 0.0},
                  {piece.end_m.x(), piece.end_m.y(), height_m}, {piece.start_m.x(), piece.start_m.y(), height_m},
                  Material::kPlaster);
    const Vector2d along = (piece.end_m - piece.start_m).normalized();
    const double length_m = (piece.end_m - piece.start_m).norm();
    for (double s = rng.uniform(0.5, 2.0); s < length_m - 0.5; s += rng.uniform(1.2, 2.6)) {
      const Vector2d at_m = piece.start_m + s * along;
      if (distance_to_ways_m(ways, at_m) > clear_m) add_thing(mesh, at_m, left_of(along), height_m, rng);
    }
  }
  mesh.add_floor(low.x(), low.y(), high.x(), high.y(), 0.0, Material::kConcrete);
  mesh.add_floor(low.x(), low.y(), high.x(), high.y(), height_m, Material::kPlaster);
}

double distance_to_ways_m(const std::vector<std::vector<Vector3d>>& ways, const Vector2d& point_m) {
  double best_m = std::numeric_limits<double>::infinity();
  for (const std::vector<Vector3d>& way : ways) {
    for (std::size_t i = 0; i + 1 < way.size(); ++i) {
      const Vector2d a = way[i].head<2>();
      const Vector2d leg = way[i + 1].head<2>() - a;
      const double share = std::clamp((point_m - a).dot(leg) / std::max(1e-9, leg.squaredNorm()), 0.0, 1.0);
      best_m = std::min(best_m, (a + share * leg - point_m).norm());
    }
  }
  return best_m;
}

}  // namespace kilter
