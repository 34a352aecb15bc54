// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/submap/cutting.h"

#include <algorithm>

namespace kilter {
namespace {

// How far a piece of the journey has got towards ending its submap; 1 = ends it.
double progress(double path_m, double turning_rad, const CuttingOptions& options) {
  return std::max(path_m / options.submap_distance_m, turning_rad / options.submap_rotation_rad);
}

std::vector<double> turning_rad(std::span<const Pose3> poses) {
  std::vector<double> turning(poses.size(), 0.0);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    turning[i] = turning[i - 1] + (poses[i - 1].inverse() * poses[i]).angle_rad();
  }
  return turning;
}

// Summed rounding must not decide whether exactly 10 m of path have been reached.
constexpr double kComplete = 1.0 - 1e-9;

}  // namespace

std::vector<OptionField> fields(CuttingOptions& o) {
  return {
      real_option("submap_distance", o.submap_distance_m, Unit::kMetre, 0.01, 1e6,
                  "Path length after which a new submap begins."),
      real_option("submap_rotation", o.submap_rotation_rad, Unit::kRadian, 0.01, 1e6,
                  "Accumulated turning after which a new submap begins."),
      count_option("min_scans", o.min_scans, 1, 1000000, "Scans that a submap holds at least before a new one begins."),
  };
}

std::vector<double> path_lengths_m(std::span<const Pose3> T_world_scan) {
  std::vector<double> path(T_world_scan.size(), 0.0);
  for (std::size_t i = 1; i < T_world_scan.size(); ++i) {
    path[i] = path[i - 1] + (T_world_scan[i].translation_m() - T_world_scan[i - 1].translation_m()).norm();
  }
  return path;
}

std::vector<ScanRange> cut_trajectory(std::span<const Pose3> T_world_scan, const CuttingOptions& options) {
  std::vector<ScanRange> ranges;
  if (T_world_scan.empty()) return ranges;
  const std::vector<double> path = path_lengths_m(T_world_scan);
  const std::vector<double> turning = turning_rad(T_world_scan);
  std::size_t first = 0;
  for (std::size_t i = 1; i < T_world_scan.size(); ++i) {
    const bool enough_scans = i - first >= static_cast<std::size_t>(options.min_scans);
    if (enough_scans && progress(path[i] - path[first], turning[i] - turning[first], options) >= kComplete) {
      ranges.push_back({first, i - 1});  // Eq. (1)
      first = i;
    }
  }
  const std::size_t last = T_world_scan.size() - 1;
  // The tail reaches from where its predecessor ended (its own first scan is a full step away from there).
  const std::size_t tail_start = first > 0 ? first - 1 : 0;
  const bool short_tail =
      progress(path[last] - path[tail_start], turning[last] - turning[tail_start], options) < 1.0 / 3;
  if (!ranges.empty() && (short_tail || last - first + 1 < static_cast<std::size_t>(options.min_scans))) {
    ranges.back().last = last;
  } else {
    ranges.push_back({first, last});
  }
  return ranges;
}

}  // namespace kilter
