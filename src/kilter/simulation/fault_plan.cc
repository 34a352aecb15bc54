// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/simulation/fault_plan.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace kilter {
namespace {

using Truth = std::span<const RobotMotion>;

// Two places nearer than this see the same things.
constexpr double kSamePlace_m = 3.0;
// True closures this close to a wrong one would outvote it.
constexpr double kWrongReach_m = 8.0;

std::size_t scan_at(const RobotMotion& robot, double share) {
  const auto last = static_cast<double>(robot.path_m.size() - 1);
  return static_cast<std::size_t>(std::lround(std::clamp(share, 0.0, 1.0) * last));
}

// The scan after the step that turns most, within a tenth of the scans.
std::size_t sharpest_turn(const RobotMotion& robot, std::size_t near) {
  const std::size_t reach = std::max<std::size_t>(1, robot.path_m.size() / 10);
  const std::size_t first = near > reach ? near - reach : 1;
  const std::size_t last = std::min(robot.path_m.size() - 1, near + reach);
  std::size_t best = first;
  double best_rad = -1.0;
  for (std::size_t i = first; i <= last; ++i) {
    const double turn_rad = (robot.T_world_sensor[i - 1].inverse() * robot.T_world_sensor[i]).angle_rad();
    if (turn_rad > best_rad) {
      best_rad = turn_rad;
      best = i;
    }
  }
  return best;
}

tl::unexpected<Error> no_room(const FaultRequest& request, const std::string& why) {
  return fail(ErrorCode::kInvalidArgument,
              "no room for the fault " + std::string(to_string(request.kind)) + ": " + why);
}

// The first scan from `begin` on that is back where the robot was in [0, end).
std::optional<Meeting> first_return(Truth truth, std::size_t robot, std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < truth[robot].path_m.size(); ++i) {
    const ScanRef here{robot, i};
    const std::optional<ScanRef> there = nearest_scan(truth, here, robot, 0, end);
    if (there && distance_m(truth, *there, here) < kSamePlace_m) return Meeting{*there, here};
  }
  return std::nullopt;
}

// The first scan of the robot from `begin` on that is near one of the first `sound[other]` scans of another robot.
std::optional<Meeting> first_meeting(Truth truth, std::size_t robot, std::size_t begin,
                                     const std::vector<std::size_t>& sound) {
  for (std::size_t i = begin; i < truth[robot].path_m.size(); ++i) {
    const ScanRef here{robot, i};
    for (std::size_t other = 0; other < truth.size(); ++other) {
      if (other == robot) continue;
      const auto there = nearest_scan(truth, here, other, 0, sound[other]);
      if (there && distance_m(truth, *there, here) < kSamePlace_m) return Meeting{*there, here};
    }
  }
  return std::nullopt;
}

// How many scans of each robot come before anything goes wrong with it.
std::vector<std::size_t> sound_scans(Truth truth, std::span<const PlannedFault> faults) {
  std::vector<std::size_t> sound;
  for (const RobotMotion& robot : truth) sound.push_back(robot.path_m.size());
  for (const PlannedFault& fault : faults) {
    sound[fault.scan.robot] = std::min(sound[fault.scan.robot], fault.first.scan + 1);
  }
  return sound;
}

std::optional<Meeting> frame_meeting(Truth truth, std::size_t robot, std::size_t begin,
                                     std::span<const PlannedFault> earlier) {
  const auto meeting = first_meeting(truth, robot, begin, sound_scans(truth, earlier));
  return meeting ? meeting : first_meeting(truth, robot, begin, sound_scans(truth, {}));
}

// The scan of the way's first half up to `scan` whose true distance from it is closest to `size_m`.
ScanRef lookalike(Truth truth, const ScanRef& scan, double size_m) {
  ScanRef best{scan.robot, 0};
  double best_m = std::abs(distance_m(truth, best, scan) - size_m);
  for (std::size_t j = 1; j < scan.scan / 2; ++j) {
    const double off_m = std::abs(distance_m(truth, {scan.robot, j}, scan) - size_m);
    if (off_m < best_m) {
      best_m = off_m;
      best = {scan.robot, j};
    }
  }
  return best;
}

// Plans what is taken for a place seen before: one about as far away as asked.
Expected<PlannedFault> mistake_place(Truth truth, PlannedFault fault) {
  const FaultRequest& request = fault.request;
  const std::string& name = truth[fault.scan.robot].name;
  if (fault.scan.scan < 2) {
    return no_room(request, fmt::format("robot {} has seen no other place before its scan {}", name, fault.scan.scan));
  }
  fault.against = fault.first = lookalike(truth, fault.scan, request.size_m);
  const double apart_m = distance_m(truth, fault.against, fault.scan);
  if (std::abs(apart_m - request.size_m) <= 0.5 * request.size_m) return fault;
  return no_room(request, fmt::format("no place in the first half of robot {}'s way to its scan {} is about {:.3g} m "
                                      "from there; the best is {:.3g} m away",
                                      name, fault.scan.scan, request.size_m, apart_m));
}

Vector6 draw_twist(const FaultRequest& request, Rng& rng) {
  const double drawn_rad = rng.uniform(0.0, 2.0 * std::numbers::pi);
  const double bearing_rad = request.bearing_rad.value_or(drawn_rad);
  const double drawn_sign = rng.uniform() < 0.5 ? -1.0 : 1.0;
  const double sign = request.bearing_rad ? 1.0 : drawn_sign;
  Vector6 twist = Vector6::Zero();
  twist[0] = request.size_m * std::cos(bearing_rad);
  twist[1] = request.size_m * std::sin(bearing_rad);
  twist[5] = sign * request.size_rad;
  return twist;
}

bool path_near(Truth truth, const ScanRef& a, const ScanRef& b) {
  return a.robot == b.robot && std::abs(truth[a.robot].path_m[a.scan] - truth[b.robot].path_m[b.scan]) < kWrongReach_m;
}

}  // namespace

Expected<PlannedFault> plan_fault(Truth truth, const FaultRequest& request, std::span<const PlannedFault> earlier,
                                  Rng rng) {
  if (request.robot < 0 || static_cast<std::size_t>(request.robot) >= truth.size()) {
    return no_room(request, "the last robot is " + truth.back().name);
  }
  const auto r = static_cast<std::size_t>(request.robot);
  if (r == 0 && request.kind == FaultKind::kFrameOffset)
    return no_room(request, "the first robot's frame is the world");
  const RobotMotion& robot = truth[r];
  PlannedFault fault;
  fault.request = request;
  fault.first = fault.against = {r, 0};
  fault.scan = {r, scan_at(robot, request.at)};
  fault.twist = draw_twist(request, rng);
  const std::size_t from = scan_at(robot, request.from);
  std::optional<Meeting> meeting;
  switch (request.kind) {
    case FaultKind::kSlip:
      fault.scan.scan =
          request.at_turn ? sharpest_turn(robot, fault.scan.scan) : std::max<std::size_t>(1, fault.scan.scan);
      fault.first = fault.against = {r, fault.scan.scan - 1};
      fault.last = fault.scan;
      return fault;
    case FaultKind::kMistakenPlace:
      return mistake_place(truth, std::move(fault));
    case FaultKind::kMissedClosure:
    case FaultKind::kWrongClosure:
      meeting = first_return(truth, r, std::max(fault.scan.scan, from + 1), from + 1);
      if (!meeting) return no_room(request, "robot " + robot.name + " does not come back to where it was");
      fault.first = request.kind == FaultKind::kMissedClosure ? ScanRef{r, from} : meeting->earlier;
      break;
    case FaultKind::kFrameOffset:
    case FaultKind::kFrameDrift:
      meeting = frame_meeting(truth, r, request.kind == FaultKind::kFrameOffset ? 0 : fault.scan.scan, earlier);
      if (!meeting) return no_room(request, "robot " + robot.name + " does not meet another");
      break;
  }
  fault.scan = meeting->later;
  fault.last = {r, std::min(std::max(scan_at(robot, request.until), fault.first.scan + 1), fault.scan.scan)};
  fault.against = meeting->earlier;
  return fault;
}

bool contradicts(Truth truth, const PlannedFault& fault, const Meeting& meeting) {
  const std::size_t r = fault.scan.robot;
  const auto after = [&](const ScanRef& ref) { return ref.robot == r && ref.scan > fault.first.scan; };
  const bool touches = meeting.earlier.robot == r || meeting.later.robot == r;
  const bool between_robots = meeting.earlier.robot != meeting.later.robot;
  switch (fault.request.kind) {
    case FaultKind::kSlip:
    case FaultKind::kMissedClosure:
      return after(meeting.earlier) != after(meeting.later);
    case FaultKind::kFrameOffset:
      return touches && between_robots;
    case FaultKind::kFrameDrift:
      return touches;
    case FaultKind::kWrongClosure:
    case FaultKind::kMistakenPlace:
      for (const ScanRef& end : {meeting.earlier, meeting.later}) {
        if (path_near(truth, end, fault.scan) || path_near(truth, end, fault.against)) return true;
      }
      return false;
  }
  return false;
}

}  // namespace kilter
