// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <string>
#include <vector>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <Eigen/Geometry>
#include <fmt/format.h>

#include "apps/kilter/commands.h"
#include "apps/kilter/common_options.h"
#include "apps/kilter/exit_status.h"
#include "apps/kilter/terminal.h"
#include "kilter/io/mission.h"
#include "kilter/report/json_writer.h"
#include "kilter/submap/cutting.h"

namespace kilter::app {
namespace {

struct InfoCommand {
  CommonOptions common;
  std::vector<std::string> sources;
  std::optional<std::string> poses_folder;
};

// What can be told of a robot from its poses and its first cloud alone.
struct RobotInfo {
  std::string name;
  bool finished_submaps = false;
  std::size_t clouds = 0;
  double path_length_m = 0.0;
  Eigen::AlignedBox3d extent_world_m;  // of the poses
  std::size_t submaps = 0;             // as `check` would cut them
  std::size_t first_points = 0;        // of the first cloud
  std::size_t first_dropped = 0;
};

Expected<RobotInfo> look_at(const RobotLog& robot, const CuttingOptions& cutting) {
  RobotInfo info;
  info.name = robot.name;
  info.finished_submaps = robot.finished_submaps;
  info.clouds = robot.T_world_cloud.size();
  info.path_length_m = path_lengths_m(robot.T_world_cloud).back();
  for (const Pose3& pose : robot.T_world_cloud) info.extent_world_m.extend(pose.translation_m());
  info.submaps = robot.finished_submaps ? info.clouds : cut_trajectory(robot.T_world_cloud, cutting).size();
  const Expected<PointCloud> cloud = robot.read_cloud(0);
  if (!cloud) return pass_up(cloud.error());
  info.first_points = cloud->points_m.size();
  info.first_dropped = cloud->dropped_nonfinite + cloud->dropped_far;
  return info;
}

std::string as_json(const std::vector<RobotInfo>& robots, const std::vector<std::string>& notes) {
  JsonWriter json;
  json.open_object().field("schema", "kilter.info/1").key("robots").open_list();
  for (const RobotInfo& robot : robots) {
    const Eigen::Vector3d low = robot.extent_world_m.min();
    const Eigen::Vector3d high = robot.extent_world_m.max();
    json.open_object(JsonWriter::Layout::kCompact).field("name", robot.name);
    json.field("finished_submaps", robot.finished_submaps).field("clouds", robot.clouds);
    json.field("path_length_m", robot.path_length_m);
    json.key("pose_min_m").value(std::span<const double>(low.data(), 3));
    json.key("pose_max_m").value(std::span<const double>(high.data(), 3));
    json.field("likely_submaps", robot.submaps).field("first_cloud_points", robot.first_points);
    json.field("first_cloud_dropped", robot.first_dropped).close();
  }
  json.close().key("notes").open_list();
  for (const std::string& note : notes) json.value(note);
  return json.close().close().take();
}

std::string as_text(const std::vector<RobotInfo>& robots) {
  std::size_t clouds = 0;
  std::size_t submaps = 0;
  for (const RobotInfo& robot : robots) {
    clouds += robot.clouds;
    submaps += robot.submaps;
  }
  std::string text = fmt::format("{} robot{}, {} clouds, likely {} submaps\n", robots.size(),
                                 robots.size() == 1 ? "" : "s", clouds, submaps);
  for (const RobotInfo& robot : robots) {
    const Eigen::Vector3d low = robot.extent_world_m.min();
    const Eigen::Vector3d high = robot.extent_world_m.max();
    text += fmt::format("{}\n  {} {}, path {:.1f} m, likely {} submaps\n", robot.name, robot.clouds,
                        robot.finished_submaps ? "finished submaps" : "scans", robot.path_length_m, robot.submaps);
    text += fmt::format("  poses x {:.1f} to {:.1f}, y {:.1f} to {:.1f}, z {:.1f} to {:.1f} m\n", low.x(), high.x(),
                        low.y(), high.y(), low.z(), high.z());
    text += fmt::format("  first cloud: {} points, {} dropped (not finite or too far)\n", robot.first_points,
                        robot.first_dropped);
  }
  return text;
}

int run_info(const InfoCommand& command) {
  const Expected<Settings> settings = read_settings(command.common);
  if (!settings) return print_error(settings.error());
  MissionOptions options;
  options.T_body_sensor = settings->T_body_sensor;
  if (command.poses_folder) options.poses_folder = *command.poses_folder;
  const Expected<Mission> mission = open_mission(command.sources, options);
  if (!mission) return print_error(mission.error());
  std::vector<RobotInfo> robots;
  for (const RobotLog& robot : mission->robots) {
    const Expected<RobotInfo> info = look_at(robot, settings->check.submap.cutting);
    if (!info) return print_error(info.error());
    robots.push_back(*info);
  }
  if (!command.common.quiet) {
    for (const std::string& note : mission->notes) print_note(note);
  }
  const Expected<void> done = print_out(command.common.json ? as_json(robots, mission->notes) : as_text(robots));
  if (done) return kExitGood;
  print_error(done.error());
  return exit_status_of_output(done.error().code);
}

}  // namespace

void add_info_command(CLI::App& program, int& status) {
  const auto command = std::make_shared<InfoCommand>();
  CLI::App* app = program.add_subcommand("info", "what a mission holds, from its poses and first clouds");
  app->add_option("SOURCE", command->sources, "a mission's folder, a robot's folder, or NAME=PATH")->required();
  app->add_option("--poses", command->poses_folder, "take DIR/ROBOT/poses.* instead of each robot's own poses")
      ->option_text("DIR");
  add_common_options(*app, command->common);
  app->callback([command, &status] { status = run_info(*command); });
}

}  // namespace kilter::app
