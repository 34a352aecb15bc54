// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/simulation/route.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kilter/base/contract.h"
#include "kilter/base/rng.h"

namespace kilter {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;
constexpr double kKnotStep_m = 0.05;
constexpr double kSharpTurn_rad = 150.0 * kPi / 180.0;

double wrapped(double angle_rad) { return std::remainder(angle_rad, 2.0 * kPi); }

double heading_rad(const Vector3d& leg_m) { return std::atan2(leg_m.y(), leg_m.x()); }

double sum_of(const auto& waves, double time_s) {
  double sum = 0.0;
  for (const auto& wave : waves) sum += wave.amplitude * std::sin(wave.rate_radps * time_s + wave.phase_rad);
  return sum;
}

}  // namespace

void Trajectory::drive_to(const Vector3d& ground_m) {
  const Knot from = knots_.back();
  const Vector3d leg_m = ground_m - from.ground_m;
  const double length_m = leg_m.norm();
  if (length_m < 1e-9) return;
  const double flat_m = leg_m.head<2>().norm();
  const double yaw_rad = flat_m > 1e-9 ? from.yaw_rad + wrapped(heading_rad(leg_m) - from.yaw_rad) : from.yaw_rad;
  const double pitch_rad = -std::atan2(leg_m.z(), flat_m);
  const int steps = std::max(1, static_cast<int>(std::ceil(length_m / kKnotStep_m)));
  for (int i = 1; i <= steps; ++i) {
    const double share = static_cast<double>(i) / steps;
    knots_.push_back({from.time_s + share * length_m / options_.speed_mps, from.path_m + share * length_m, yaw_rad,
                      pitch_rad, from.ground_m + share * leg_m});
  }
}

void Trajectory::turn_to(double yaw_rad) {
  Knot knot = knots_.back();
  const double turn_rad = wrapped(yaw_rad - knot.yaw_rad);
  knot.time_s += std::abs(turn_rad) / options_.turn_rate_radps;
  knot.yaw_rad += turn_rad;
  knots_.push_back(knot);
}

// Drives to the corner's arc and along it; the rest of the leg is left to the next call.
void Trajectory::round_corner(const Vector3d& before_m, const Vector3d& corner_m, const Vector3d& after_m) {
  const Vector3d in = corner_m - before_m;
  const Vector3d out = after_m - corner_m;
  const double turn_rad = std::abs(wrapped(heading_rad(out) - heading_rad(in)));
  if (turn_rad > kSharpTurn_rad) {
    drive_to(corner_m);
    turn_to(heading_rad(out));
    return;
  }
  const double shortest_m = std::min(in.norm(), out.norm());
  const double cut_m = std::min(options_.corner_radius_m * std::tan(0.5 * turn_rad), 0.45 * shortest_m);
  const Vector3d first = corner_m - cut_m * in.normalized();
  const Vector3d last = corner_m + cut_m * out.normalized();
  drive_to(first);
  // A quadratic Bezier curve: leaves and arrives along the legs, close to an arc.
  const int steps = std::max(1, static_cast<int>(std::ceil(turn_rad / 0.05)));
  for (int i = 1; i <= steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    drive_to((1.0 - t) * (1.0 - t) * first + 2.0 * t * (1.0 - t) * corner_m + t * t * last);
  }
}

// A body of 0.6 m length does not change its pitch from one knot to the next.
void Trajectory::smooth_pitch() {
  constexpr int kHalfWindow = 6;
  std::vector<double> smooth(knots_.size());
  const int count = static_cast<int>(knots_.size());
  for (int i = 0; i < count; ++i) {
    const int low = std::max(0, i - kHalfWindow);
    const int high = std::min(count - 1, i + kHalfWindow);
    double sum = 0.0;
    for (int k = low; k <= high; ++k) sum += knots_[static_cast<std::size_t>(k)].pitch_rad;
    smooth[static_cast<std::size_t>(i)] = sum / (high - low + 1);
  }
  for (std::size_t i = 0; i < knots_.size(); ++i) knots_[i].pitch_rad = smooth[i];
}

Trajectory Trajectory::along(const std::vector<Vector3d>& corners_m, const RouteOptions& options) {
  KILTER_EXPECTS(corners_m.size() >= 2);
  Trajectory trajectory;
  trajectory.options_ = options;
  trajectory.knots_.push_back({0.0, 0.0, heading_rad(corners_m[1] - corners_m[0]), 0.0, corners_m[0]});
  for (std::size_t i = 1; i + 1 < corners_m.size(); ++i) {
    trajectory.round_corner(corners_m[i - 1], corners_m[i], corners_m[i + 1]);
  }
  trajectory.drive_to(corners_m.back());
  trajectory.smooth_pitch();

  Rng rng(options.seed, 0x5A7);
  const auto waves = [&rng](double deviation) {
    std::vector<Wave> made;
    for (int i = 0; i < 3; ++i) {
      const double rate_radps = rng.uniform(1.0, 8.0);
      made.push_back({deviation * std::sqrt(2.0 / 3.0), rate_radps, rng.uniform(0.0, 2.0 * kPi)});
    }
    return made;
  };
  trajectory.roll_ = waves(options.sway_rad);
  trajectory.pitch_ = waves(options.sway_rad);
  trajectory.heave_ = waves(options.heave_m);
  return trajectory;
}

Trajectory::Knot Trajectory::interpolate(double time_s) const {
  const auto after = std::upper_bound(knots_.begin(), knots_.end(), time_s,
                                      [](double time, const Knot& knot) { return time < knot.time_s; });
  if (after == knots_.begin()) return knots_.front();
  if (after == knots_.end()) return knots_.back();
  const Knot& b = *after;
  const Knot& a = *(after - 1);
  const double share = (time_s - a.time_s) / (b.time_s - a.time_s);
  return {time_s, a.path_m + share * (b.path_m - a.path_m), a.yaw_rad + share * (b.yaw_rad - a.yaw_rad),
          a.pitch_rad + share * (b.pitch_rad - a.pitch_rad), a.ground_m + share * (b.ground_m - a.ground_m)};
}

double Trajectory::path_m(double time_s) const { return interpolate(time_s).path_m; }

Pose3 Trajectory::at(double time_s) const {
  const Knot knot = interpolate(time_s);
  const double height_m = options_.sensor_height_m + sum_of(heave_, time_s);
  const Eigen::Quaterniond rotation = Eigen::AngleAxisd(knot.yaw_rad, Vector3d::UnitZ()) *
                                      Eigen::AngleAxisd(knot.pitch_rad + sum_of(pitch_, time_s), Vector3d::UnitY()) *
                                      Eigen::AngleAxisd(sum_of(roll_, time_s), Vector3d::UnitX());
  return {rotation, knot.ground_m + Vector3d(0.0, 0.0, height_m)};
}

std::vector<double> Trajectory::scan_times_s(double step_m, double step_rad) const {
  KILTER_EXPECTS(step_m > 0.0 && step_rad > 0.0);
  std::vector<double> times_s;
  double last_m = 0.0;
  double last_rad = 0.0;
  for (const Knot& knot : knots_) {
    const bool due = times_s.empty() || knot.path_m - last_m >= step_m || std::abs(knot.yaw_rad - last_rad) >= step_rad;
    if (!due) continue;
    // A turn on the spot is one long knot: scans at equal angles within it.
    const int parts = times_s.empty() ? 1 : std::max(1, static_cast<int>(std::abs(knot.yaw_rad - last_rad) / step_rad));
    const double before_s = parts > 1 ? (&knot - 1)->time_s : knot.time_s;
    for (int part = 1; part <= parts; ++part) {
      times_s.push_back(before_s + (knot.time_s - before_s) * part / parts);
    }
    last_m = knot.path_m;
    last_rad = knot.yaw_rad;
  }
  return times_s;
}

}  // namespace kilter
