// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/simulate.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>

#include <fmt/format.h>

namespace kilter {
namespace {

std::optional<double> number(const std::string& text) {
  double value = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// Bad arguments of the library are bad usage of the command.
Error as_usage(Error error) {
  if (error.code == ErrorCode::kInvalidArgument) error.code = ErrorCode::kUsage;
  return error;
}

Expected<std::vector<FaultRequest>> parse_faults(const std::vector<std::string>& texts) {
  const auto nones = std::count(texts.begin(), texts.end(), "none");
  if (nones > 0 && nones < std::ssize(texts)) {
    return fail(ErrorCode::kUsage, "--fault none: other faults are asked for as well", {}, "ask for either");
  }
  std::vector<FaultRequest> faults;
  for (const std::string& text : texts) {
    if (text == "none") continue;
    Expected<FaultRequest> fault = parse_fault(text);
    if (!fault) return pass_up(fault.error());
    faults.push_back(*fault);
  }
  return faults;
}

// Closures and odometry have their say in what a map shows of a fault.
std::vector<std::string> notes_on_sizes(const std::vector<FaultRequest>& asked, const SimulatedMission& mission) {
  std::vector<std::string> notes;
  for (std::size_t i = 0; i < asked.size(); ++i) {
    const Fault& fault = mission.faults()[i];
    if (std::abs(fault.size_m - asked[i].size_m) <= 0.1 * asked[i].size_m) continue;
    notes.push_back(fmt::format("{} of robot {}: asked for {} m, and the map shows {:.3g} m", to_string(fault.kind),
                                mission.robots()[static_cast<std::size_t>(fault.robot)].name, asked[i].size_m,
                                fault.size_m));
  }
  return notes;
}

}  // namespace

Expected<FaultRequest> parse_fault(const std::string& text) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, ':');) parts.push_back(part);
  const auto refuse = [&](const std::string& why) {
    return fail(
        ErrorCode::kUsage, "fault \"" + printable(text) + "\": " + why, {},
        "KIND[:ROBOT[:SIZE_M[:AT]]] with KIND slip, missed-closure, frame-offset, frame-drift, wrong-closure or "
        "mistaken-place, e.g. slip:a:0.4:0.6");
  };
  const std::optional<FaultKind> kind = parts.empty() ? std::nullopt : fault_kind_from(parts[0]);
  if (!kind) return refuse("there is no such kind");
  FaultRequest fault{.kind = *kind};
  fault.robot = *kind == FaultKind::kFrameOffset || *kind == FaultKind::kFrameDrift ? 1 : 0;
  if (parts.size() > 1) {
    const std::size_t robot = kRobotNames.find(parts[1]);
    if (parts[1].size() != 1 || robot == std::string_view::npos) return refuse("robots are a to e");
    fault.robot = static_cast<int>(robot);
  }
  if (parts.size() > 2) {
    const std::optional<double> size_m = number(parts[2]);
    if (!size_m || !(*size_m > 0.0 && *size_m <= 100.0)) return refuse("the size must be metres above 0, up to 100");
    fault.size_m = *size_m;
  }
  if (parts.size() > 3) {
    if (*kind == FaultKind::kFrameOffset) return refuse("a frame is off from the first scan on; there is no AT");
    const std::optional<double> at = number(parts[3]);
    if (!at || !(*at >= 0.0 && *at <= 1.0)) return refuse("AT must be a share of the robot's scans, 0 to 1");
    fault.at = *at;
  }
  if (parts.size() > 4) return refuse("there are too many parts");
  return fault;
}

Expected<SimulateSummary> simulate(const SimulateRequest& request, const RunContext& run) {
  Expected<LidarModel> lidar = lidar_model(request.beams);
  if (!lidar) return pass_up(as_usage(lidar.error()));
  lidar->columns = request.columns;
  lidar->range_noise_m = request.range_noise_m;
  lidar->motion_residual = request.motion_residual;
  Expected<Scene> scene = make_scene(request.scene, request.options);
  if (!scene) return pass_up(as_usage(scene.error()));
  scene->scan_step_m = request.scan_step_m.value_or(scene->scan_step_m);
  const Expected<std::vector<FaultRequest>> asked = parse_faults(request.faults);
  if (!asked) return pass_up(asked.error());
  if (!request.faults.empty()) scene->faults = *asked;
  Expected<SimulatedMission> mission = SimulatedMission::plan(std::move(*scene), *lidar, request.options.seed);
  if (!mission && mission.error().hint.empty()) mission.error().hint = "other faults by --fault, or --fault none";
  if (!mission) return pass_up(as_usage(mission.error()));
  if (Expected<void> written = write_mission(*mission, request.writer, run); !written) return pass_up(written.error());
  SimulateSummary summary{{}, mission->scan_count(), mission->faults(), notes_on_sizes(*asked, *mission)};
  for (const SimulatedRobot& robot : mission->robots()) summary.robots.push_back(robot.name);
  return summary;
}

}  // namespace kilter
