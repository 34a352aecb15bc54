// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/simulation/closures.h"

namespace kilter {
namespace {

// Number of scans of a robot that lie at least `gap_m` of path before scan i.
std::size_t count_before(const RobotMotion& robot, std::size_t i, double gap_m) {
  std::size_t count = i;
  while (count > 0 && robot.path_m[i] - robot.path_m[count - 1] < gap_m) --count;
  return count;
}

void meet(std::span<const RobotMotion> truth, std::size_t earlier, std::size_t later, const SlamOptions& options,
          std::vector<Meeting>& meetings) {
  const RobotMotion& robot = truth[later];
  double last_m = -options.closure_spacing_m;
  for (std::size_t i = 0; i < robot.path_m.size(); ++i) {
    if (robot.path_m[i] - last_m < options.closure_spacing_m) continue;
    const std::size_t limit =
        earlier == later ? count_before(robot, i, options.closure_gap_m) : truth[earlier].path_m.size();
    const ScanRef here{later, i};
    const std::optional<ScanRef> there = nearest_scan(truth, here, earlier, 0, limit);
    if (!there || distance_m(truth, *there, here) > options.closure_distance_m) continue;
    meetings.push_back({*there, here});
    last_m = robot.path_m[i];
  }
}

}  // namespace

double distance_m(std::span<const RobotMotion> truth, const ScanRef& a, const ScanRef& b) {
  return (truth[a.robot].T_world_sensor[a.scan].translation_m() - truth[b.robot].T_world_sensor[b.scan].translation_m())
      .norm();
}

std::optional<ScanRef> nearest_scan(std::span<const RobotMotion> truth, const ScanRef& to, std::size_t robot,
                                    std::size_t first, std::size_t last) {
  std::optional<ScanRef> best;
  double best_m = 0.0;
  for (std::size_t j = first; j < last; ++j) {
    const double here_m = distance_m(truth, {robot, j}, to);
    if (best && here_m >= best_m) continue;
    best = ScanRef{robot, j};
    best_m = here_m;
  }
  return best;
}

std::vector<Meeting> find_meetings(std::span<const RobotMotion> truth, const SlamOptions& options) {
  std::vector<Meeting> meetings;
  for (std::size_t later = 0; later < truth.size(); ++later) {
    for (std::size_t earlier = 0; earlier <= later; ++earlier) {
      if (earlier == later ? options.within_robots : options.between_robots) {
        meet(truth, earlier, later, options, meetings);
      }
    }
  }
  return meetings;
}

}  // namespace kilter
