// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/mission.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <system_error>

#include "kilter/io/file.h"
#include "kilter/io/robot_folder.h"

namespace kilter {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kLayout =
    "a robot is a folder with poses.* and scans/ or submaps/; a mission is a folder of such folders";

// Names become JSON keys like "a,b", folders of --poses and cells of CSV files. \return what is wrong, or nothing.
std::optional<std::string> find_fault(const std::string& name) {
  if (name.empty()) return "it is empty";
  if (name == "." || name == "..") return "it stands for a folder";
  if (name.find('/') != std::string::npos) return "it holds a '/'";
  if (name.find(',') != std::string::npos) return "it holds a comma";
  if (printable(name, name.size()) != name) return "it holds control characters or is not UTF-8";
  return std::nullopt;
}

// The last part of a path that is a name: "b" of "a/b/", and of "." the folder that it is.
std::string name_of_folder(const fs::path& folder) {
  const fs::path last = folder.has_filename() ? folder.filename() : folder.parent_path().filename();
  if (!last.empty() && last != "." && last != "..") return last.string();
  std::error_code error;
  return fs::canonical(folder, error).filename().string();
}

Expected<RobotFolder> robot_from_folder(const fs::path& folder) {
  const std::string name = name_of_folder(folder);
  if (const auto fault = find_fault(name)) {
    return fail(ErrorCode::kUnsupported, fmt::format("this folder's name cannot be a robot's: {}", *fault),
                shown(folder), "give the robot another name: NAME=PATH");
  }
  return RobotFolder{name, folder, folder};
}

Expected<void> check_is_folder(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) {
    return fail(ErrorCode::kNotFound, "there is no such folder", shown(path));
  }
  if (status.type() == fs::file_type::directory) return {};
  if (error) return fail(ErrorCode::kIo, fmt::format("cannot be read: {}", error.message()), shown(path));
  return fail(ErrorCode::kUnsupported, "expected a folder, found a file", shown(path), std::string(kLayout));
}

Expected<std::vector<RobotFolder>> robots_of_named(const std::string& name, const fs::path& folder) {
  if (const auto fault = find_fault(name)) {
    return fail(ErrorCode::kUsage, fmt::format("\"{}\" cannot be a robot's name: {}", printable(name, 80), *fault));
  }
  if (auto ok = check_is_folder(folder); !ok) {
    ok.error().hint = fmt::format("a folder whose own name has a '=' is written ./{}=...", printable(name, 80));
    return pass_up(std::move(ok.error()));
  }
  if (!is_robot_folder(folder)) {
    return fail(ErrorCode::kNotFound, "expected scans/ or submaps/ in it, found neither", shown(folder),
                std::string(kLayout));
  }
  return std::vector<RobotFolder>{{name, folder, folder}};
}

Expected<std::vector<RobotFolder>> robots_of_folder(const fs::path& folder) {
  if (auto ok = check_is_folder(folder); !ok) return pass_up(ok.error());
  std::vector<fs::path> candidates;
  if (is_robot_folder(folder)) {
    candidates.push_back(folder);
  } else {
    const auto names = list_folder(folder);
    if (!names) return pass_up(names.error());
    for (const std::string& name : *names) {
      if (!name.starts_with('.') && is_robot_folder(folder / name)) candidates.push_back(folder / name);
    }
  }
  if (candidates.empty()) {
    return fail(ErrorCode::kEmptyInput, "no robot: neither it nor a folder in it holds scans/ or submaps/",
                shown(folder), std::string(kLayout));
  }
  std::vector<RobotFolder> robots;
  for (const fs::path& candidate : candidates) {
    Expected<RobotFolder> robot = robot_from_folder(candidate);
    if (!robot) return pass_up(robot.error());
    robots.push_back(*std::move(robot));
  }
  return robots;
}

Expected<std::vector<RobotFolder>> robots_of_source(const std::string& source) {
  const std::size_t equals = source.find('=');
  if (equals != std::string::npos && source.find('/') > equals) {
    return robots_of_named(source.substr(0, equals), source.substr(equals + 1));
  }
  return robots_of_folder(source);
}

Expected<std::vector<RobotFolder>> find_robots(const std::vector<std::string>& sources) {
  std::vector<RobotFolder> robots;
  for (const std::string& source : sources) {
    auto found = robots_of_source(source);
    if (!found) return pass_up(found.error());
    std::move(found->begin(), found->end(), std::back_inserter(robots));
  }
  std::sort(robots.begin(), robots.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  const auto twice =
      std::adjacent_find(robots.begin(), robots.end(), [](const auto& a, const auto& b) { return a.name == b.name; });
  if (twice != robots.end()) {
    return fail(ErrorCode::kUsage,
                fmt::format("robot \"{}\" is given twice: {} and {}", twice->name, shown(twice->folder),
                            shown(std::next(twice)->folder)),
                {}, "give one of them another name: NAME=PATH");
  }
  return robots;
}

// A robot's own entry, else that for all.
const Pose3* sensor_on_body(const MissionOptions& options, const std::string& robot) {
  for (const std::string& key : {robot, std::string()}) {
    if (const auto found = options.T_body_sensor.find(key); found != options.T_body_sensor.end()) {
      return &found->second;
    }
  }
  return nullptr;
}

// T_world_sensor = T_world_body * T_body_sensor. A finished submap's frame is its own; no sensor is involved.
void move_to_sensor(RobotLog& log, const MissionOptions& options, std::vector<std::string>& notes) {
  const Pose3* T_body_sensor = sensor_on_body(options, log.name);
  if (T_body_sensor == nullptr) return;
  if (log.finished_submaps) {
    notes.push_back(fmt::format("robot {}: T_body_sensor does not apply to finished submaps", log.name));
    return;
  }
  for (Pose3& T_world_cloud : log.T_world_cloud) T_world_cloud = T_world_cloud * *T_body_sensor;
}

Expected<void> check_sensor_names(const MissionOptions& options, const std::vector<RobotFolder>& robots) {
  for (const auto& [name, T_body_sensor] : options.T_body_sensor) {
    const auto is_named = [&key = name](const RobotFolder& robot) { return robot.name == key; };
    if (name.empty() || std::any_of(robots.begin(), robots.end(), is_named)) continue;
    return fail(ErrorCode::kConfig,
                fmt::format("T_body_sensor is given for \"{}\", but no robot has that name", printable(name, 80)));
  }
  return {};
}

}  // namespace

Expected<Mission> open_mission(const std::vector<std::string>& sources, const MissionOptions& options) {
  if (sources.empty()) return fail(ErrorCode::kUsage, "no source given", {}, std::string(kLayout));
  auto robots = find_robots(sources);
  if (!robots) return pass_up(robots.error());
  if (auto ok = check_sensor_names(options, *robots); !ok) return pass_up(ok.error());
  Mission mission;
  for (RobotFolder& robot : *robots) {
    if (options.poses_folder) robot.poses_folder = *options.poses_folder / robot.name;
    Expected<RobotLog> log = open_robot(robot, mission.notes);
    if (!log) return pass_up(log.error());
    move_to_sensor(*log, options, mission.notes);
    mission.robots.push_back(*std::move(log));
  }
  return mission;
}

}  // namespace kilter
