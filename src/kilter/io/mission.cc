// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/mission.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <system_error>

#include "kilter/io/cloud_file.h"
#include "kilter/io/file.h"
#include "kilter/io/octree_reader.h"
#include "kilter/io/pose_file.h"
#include "kilter/io/sources/cloud_folder.h"
#include "kilter/io/sources/find_robots.h"
#include "kilter/io/sources/robot_folder.h"

namespace kilter {
namespace {

namespace fs = std::filesystem;

// Of a distance between two surfaces, each somewhere in its cell: the root of a sixth, in cells.
constexpr double kSigmaOfCells = 0.408;

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
  if (!log.clouds_in_world) return;
  // Where the source draws clouds in the world, they were brought back to the body.
  log.read_cloud = [read = std::move(log.read_cloud), T = T_body_sensor->inverse().isometry()](std::size_t i) {
    Expected<PointCloud> cloud = read(i);
    if (!cloud) return cloud;
    for (Eigen::Vector3f& point_m : cloud->points_m) point_m = (T * point_m.cast<double>()).cast<float>();
    return cloud;
  };
}

Expected<void> check_sensor_names(const MissionOptions& options, const std::vector<FoundRobot>& robots) {
  for (const auto& [name, T_body_sensor] : options.T_body_sensor) {
    const auto is_named = [&key = name](const FoundRobot& robot) { return robot.name == key; };
    if (name.empty() || std::any_of(robots.begin(), robots.end(), is_named)) continue;
    return fail(ErrorCode::kConfig,
                fmt::format("T_body_sensor is given for \"{}\", but no robot has that name", printable(name, 80)));
  }
  return {};
}

// DIR/ROBOT/poses.* of --poses, for kinds that know nothing of it.
Expected<void> replace_poses(RobotLog& log, const fs::path& folder) {
  const auto pose_file = find_pose_file(folder);
  if (!pose_file) return pass_up(pose_file.error());
  auto poses = read_pose_file(*pose_file);
  if (!poses) return pass_up(poses.error());
  if (poses->T_world_cloud.size() != log.T_world_cloud.size()) {
    return fail(ErrorCode::kCountMismatch,
                fmt::format("{} poses, but the {} has {} clouds with a pose", poses->T_world_cloud.size(), log.kind,
                            log.T_world_cloud.size()),
                shown(*pose_file), "one pose for each of them, in the same order");
  }
  if (!poses->files.empty()) {
    std::vector<std::string> clouds;
    for (std::size_t i = 0; i < poses->files.size(); ++i) clouds.push_back(fs::path(log.cloud_name(i)).filename());
    // A bag's clouds have no files of their own.
    if (cloud_format_of(clouds.front()) || has_octree_name(clouds.front())) {
      if (auto ok = check_names(clouds, *poses, *pose_file); !ok) return pass_up(ok.error());
    }
  }
  if (log.stamps_ns.empty()) {
    take_stamps(log, *poses);
  } else {
    log.pose_stamps_ns = stamps_ns_of(*poses).value_or(std::vector<std::int64_t>());
  }
  log.T_world_cloud = std::move(poses->T_world_cloud);
  return {};
}

// --poses of what is there, and a folder for every robot in it.
Expected<void> check_poses_folder(const MissionOptions& options, const std::vector<FoundRobot>& robots) {
  if (!options.poses_folder) return {};
  const fs::path& folder = *options.poses_folder;
  if (is_file(folder)) {
    return fail(ErrorCode::kUnsupported, "expected a folder that holds ROBOT/poses.* for each robot, found a file",
                shown(folder), "name the folder above the robots' folders");
  }
  if (auto type = type_at(folder); !type) {
    if (type.error().hint.empty()) type.error().hint = "--poses takes a folder that holds ROBOT/poses.* for each robot";
    return pass_up(std::move(type.error()));
  }
  for (const FoundRobot& robot : robots) {
    const auto type = type_at(folder / robot.name);
    if (type || type.error().code != ErrorCode::kNotFound || !type.error().hint.empty()) continue;
    return fail(ErrorCode::kNotFound, fmt::format("expected {0}/poses.* in it, found no {0}", printable(robot.name)),
                shown(folder),
                find_pose_file(folder) ? "name the folder above the robots' folders"
                                       : "call the robot as its folder there is called: NAME=PATH");
  }
  return {};
}

Expected<RobotLog> open_robot(const FoundRobot& robot, const MissionOptions& options, std::vector<std::string>& notes) {
  SourceRequest request{robot.path, robot.name, std::nullopt, robot.topics};
  if (options.poses_folder) request.poses_folder = *options.poses_folder / robot.name;
  request.glance = options.glance && !options.poses_folder;
  Expected<RobotLog> log = robot.kind->open(request, notes);
  if (!log) return log;
  log->kind = robot.kind->name;
  if (request.poses_folder && robot.kind->open != open_robot_folder) {
    if (auto ok = replace_poses(*log, *request.poses_folder); !ok) return pass_up(ok.error());
  }
  if (log->clouds_found == 0) log->clouds_found = log->T_world_cloud.size();
  if (log->poses_found == 0) log->poses_found = log->T_world_cloud.size();
  move_to_sensor(*log, options, notes);
  return log;
}

void count_in(const RobotLog& log, bool is_own_folder, SourceSummary& source) {
  source.kind = source.robots == 0 || source.kind == log.kind ? log.kind : "folder of several kinds";
  if (is_own_folder) source.kind = "mission";
  source.finished_submaps = source.finished_submaps || log.finished_submaps;
  source.clouds += log.T_world_cloud.size();
  source.clouds_unread += log.clouds_unread;
  ++source.robots;
}

}  // namespace

Expected<Mission> open_mission(const std::vector<std::string>& sources, const MissionOptions& options) {
  if (sources.empty()) return fail(ErrorCode::kUsage, "no source given", {}, known_kinds());
  auto robots = find_robots(sources);
  if (!robots) return pass_up(robots.error());
  if (auto ok = check_sensor_names(options, *robots); !ok) return pass_up(ok.error());
  if (auto ok = check_poses_folder(options, *robots); !ok) return pass_up(ok.error());
  Mission mission;
  for (const std::string& source : sources) mission.sources.emplace_back().source = source;
  for (const FoundRobot& robot : *robots) {
    Expected<RobotLog> log = open_robot(robot, options, mission.notes);
    if (!log) return pass_up(log.error());
    if (!robot.links.empty()) {
      mission.notes.push_back(fmt::format("robot {}: {} {} to the same folder, and {} passed over", robot.name,
                                          some_of(robot.links), robot.links.size() == 1 ? "leads" : "lead",
                                          robot.links.size() == 1 ? "is" : "are"));
    }
    if (!robot.left_out.empty()) {
      mission.notes.push_back(fmt::format(
          "beside robot {}: {} {} of another kind than a robot's folder, and left out; name the robots one by one to "
          "take {} too (NAME=PATH)",
          robot.name, some_of(robot.left_out), robot.left_out.size() == 1 ? "is" : "are",
          robot.left_out.size() == 1 ? "it" : "them"));
    }
    count_in(*log, robot.kind->open == open_robot_folder, mission.sources[robot.source]);
    mission.robots.push_back(*std::move(log));
  }
  return mission;
}

std::vector<std::string> notes_on_cells(const Mission& mission, double resolution_m) {
  std::vector<std::string> notes;
  for (const RobotLog& robot : mission.robots) {
    const double cell_m = robot.cell_size_m.value_or(resolution_m);
    if (!robot.cell_size_m) continue;
    const bool as_they_are = std::abs(cell_m / resolution_m - 1.0) < 1e-6;
    const std::string compared =
        as_they_are
            ? ""
            : fmt::format(", compared at {} m; --set resolution={} takes them as they are", resolution_m, cell_m);
    notes.push_back(
        fmt::format("robot {}: its octrees have cells of {} m{}; they keep no points, only cells: offsets are good to "
                    "about {:.2g} m "
                    "(one sigma), and a much smaller tolerance cannot be shown",
                    robot.name, cell_m, compared, std::max(cell_m, resolution_m) * kSigmaOfCells));
  }
  return notes;
}

std::string describe(const SourceSummary& source) {
  const auto counted = [](std::size_t count, std::string_view what) {
    return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
  };
  const std::string clouds = counted(source.clouds, source.finished_submaps ? "submap" : "scan");
  const std::string unread =
      source.clouds_unread > 0 ? fmt::format(" and {} that were not looked at", source.clouds_unread) : "";
  return fmt::format("{}, {}{}, {}", source.kind, clouds, unread, counted(source.robots, "robot"));
}

}  // namespace kilter
