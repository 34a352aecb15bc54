// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/known_cuts.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "apps/kilter/unused_keys.h"
#include "kilter/io/file.h"
#include "kilter/io/submap_poses.h"

namespace kilter::app {
namespace {

// Where both name a folder that is there, by what the names lead to.
bool same_poses(const std::optional<std::string>& a, const std::optional<std::string>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  std::error_code error;
  return *a == *b || std::filesystem::equivalent(*a, *b, error);
}

constexpr double kFarMove_m = 5.0;  // of half the submaps: no correction of a map that odometry held together

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::string note_on_moves(const std::string& graph, const std::vector<SubmapMove>& moves) {
  std::vector<double> distances_m;
  std::vector<double> angles_deg;
  for (const SubmapMove& move : moves) {
    distances_m.push_back(move.distance_m);
    angles_deg.push_back(move.angle_rad * 180.0 / std::numbers::pi);
  }
  const auto [near_m, far_m] = std::minmax_element(distances_m.begin(), distances_m.end());
  const auto [least_deg, most_deg] = std::minmax_element(angles_deg.begin(), angles_deg.end());
  const double median_m = median_of(distances_m);
  return fmt::format(
      "{}: submaps moved by {:.2f} to {:.2f} m (median {:.2f} m), {:.1f} to {:.1f} deg{}", printable(graph), *near_m,
      *far_m, median_m, *least_deg, *most_deg,
      median_m > kFarMove_m ? "; so far as that looks like the graph of another map, or in another frame" : "");
}

}  // namespace

Expected<Cuts> read_cuts_for(Mission& mission, const std::string& result) {
  Expected<Cuts> cuts = read_cuts(result);
  if (!cuts) return cuts;
  std::vector<std::string> known;
  for (const auto& [robot, ranges] : *cuts) known.push_back(robot);
  std::vector<std::string> unknown;
  for (const RobotLog& robot : mission.robots) {
    if (!cuts->contains(robot.name)) unknown.push_back(robot.name);
  }
  if (unknown.size() == mission.robots.size()) {
    return fail(
        ErrorCode::kCountMismatch,
        fmt::format("cuts for {}, and none for the robots that there are: {}", some_of(known), some_of(unknown)),
        printable(result), "call robots as they were called there: NAME=PATH");
  }
  for (const RobotLog& robot : mission.robots) {
    const auto of_robot = cuts->find(robot.name);
    if (of_robot == cuts->end() || robot.finished_submaps) continue;
    const std::size_t covered = of_robot->second.back().last + 1;
    if (covered == robot.T_world_cloud.size()) continue;
    return fail(ErrorCode::kCountMismatch,
                fmt::format("robot {} has {} scans there, but {} here", printable(robot.name), covered,
                            robot.T_world_cloud.size()),
                printable(result), "use --cuts with a result made from the same scans");
  }
  if (!unknown.empty()) {
    mission.notes.push_back(fmt::format("{} has no cuts for {}, cut anew", printable(result), some_of(unknown)));
  }
  return cuts;
}

Expected<Cuts> place_submaps(Mission& mission, CheckOptions& options, const std::optional<std::string>& cuts_result,
                             const std::optional<std::string>& submap_poses, const std::optional<std::string>& poses) {
  Cuts cuts;
  const auto is_finished = [](const RobotLog& robot) { return robot.finished_submaps; };
  const bool all_finished = std::all_of(mission.robots.begin(), mission.robots.end(), is_finished);
  if (cuts_result && all_finished) {
    mission.notes.push_back("finished submaps are not cut: --cuts has no effect on them");
  } else if (cuts_result) {
    Expected<Cuts> known = read_cuts_for(mission, *cuts_result);
    if (!known) return known;
    cuts = *std::move(known);
    if (auto note = take_keys_of_cuts(*cuts_result, options)) mission.notes.push_back(*std::move(note));
  }
  if (!submap_poses) return cuts;
  if (cuts_result && !all_finished) {
    const std::optional<std::string> there = poses_of_result(*cuts_result);
    if (!same_poses(there, poses)) {
      mission.notes.push_back(fmt::format("{} was made {}, and this is not: inside submaps, scans lie otherwise",
                                          printable(*cuts_result),
                                          there ? "with --poses " + printable(*there) : "without --poses"));
    }
  }
  const Expected<std::vector<SubmapMove>> moved = move_submaps(*submap_poses, cuts, mission.robots);
  if (!moved) return pass_up(moved.error());
  mission.notes.push_back(note_on_moves(*submap_poses, *moved));
  return cuts;
}

}  // namespace kilter::app
