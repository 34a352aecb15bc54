// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdint>
#include <ctime>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
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
#include "kilter/io/inspection.h"
#include "kilter/io/mission.h"
#include "kilter/report/json_writer.h"

namespace kilter::app {
namespace {

struct InfoCommand {
  CommonOptions common;
  std::vector<std::string> sources;
  std::optional<std::string> poses_folder;
};

// Unix times of this millennium are dates; anything else counts from a zero of its own.
bool is_unix_time(std::int64_t stamp_ns) { return stamp_ns >= 946'684'800'000'000'000; }

std::string date_of(std::int64_t stamp_ns) {
  const auto seconds = static_cast<std::time_t>(stamp_ns / 1'000'000'000);
  std::tm utc{};
  if (gmtime_r(&seconds, &utc) == nullptr) return "?";
  char text[32];
  return {text, std::strftime(text, sizeof(text), "%Y-%m-%d %H:%M:%S", &utc)};
}

std::string stamps_in_words(const RobotInspection& robot) {
  if (!robot.first_ns) return "no stamps";
  const double seconds = 1e-9 * static_cast<double>(*robot.last_ns - *robot.first_ns);
  const std::string begin = is_unix_time(*robot.first_ns)
                                ? fmt::format("Unix time, {} UTC", date_of(*robot.first_ns))
                                : fmt::format("from {:.3f} s", 1e-9 * static_cast<double>(*robot.first_ns));
  return fmt::format("stamps in {}: {}, {:.1f} s", robot.stamp_unit, begin, seconds);
}

std::string points_in_words(const RobotInspection& robot) {
  if (!robot.points) return "points not counted";
  return fmt::format("{}{} {}{}", robot.points->estimated ? "about " : "", robot.points->points,
                     robot.points_are_voxels ? "occupied voxels" : "points", robot.clouds_unread > 0 ? " in all" : "");
}

std::string counted(std::size_t count, std::string_view what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

// Whatever else the frames are, a ground robot's vertical is the direction it moves in least. Nothing where poses are
// too close together to tell.
std::optional<std::string_view> flattest_axis(const RobotInspection& robot) {
  const Eigen::Vector3d size_m = robot.extent_world_m.sizes();
  if (size_m.maxCoeff() < 1.0) return std::nullopt;
  Eigen::Index least = 0;
  size_m.minCoeff(&least);
  return std::string_view("xyz").substr(static_cast<std::size_t>(least), 1);
}

std::string frame_in_words(const RobotInspection& robot) {
  const std::optional<std::string_view> axis = flattest_axis(robot);
  if (!axis) return "poses too close together to tell which way is up";
  return *axis == "z" ? "z seems to be up" : fmt::format("{} varies least, kilter takes z as up", *axis);
}

bool are_lengths_metric(const Inspection& inspection, const RobotInspection& robot) {
  return std::none_of(inspection.oddities.begin(), inspection.oddities.end(),
                      [&](const Oddity& oddity) { return oddity.code == "millimetres" && oddity.robot == robot.name; });
}

void write_optional(JsonWriter& json, std::string_view key, const std::optional<std::int64_t>& stamp_ns) {
  json.field(key, stamp_ns ? std::optional(1e-9 * static_cast<double>(*stamp_ns)) : std::nullopt);
}

void write_robot(JsonWriter& json, const RobotInspection& robot, bool lengths_metric) {
  const Eigen::Vector3d low = robot.extent_world_m.min();
  const Eigen::Vector3d high = robot.extent_world_m.max();
  json.open_object(JsonWriter::Layout::kCompact).field("name", robot.name).field("kind", robot.kind);
  json.field("finished_submaps", robot.finished_submaps).field("clouds", robot.clouds);
  json.field("clouds_found", robot.clouds_found).field("poses_found", robot.poses_found);
  json.field("clouds_unread", robot.clouds_unread);
  json.field("points", robot.points ? std::optional(static_cast<double>(robot.points->points)) : std::nullopt);
  json.field("points_estimated", robot.points && robot.points->estimated);
  json.field("path_length_m", robot.path_length_m);
  json.key("pose_min_m").value(std::span<const double>(low.data(), 3));
  json.key("pose_max_m").value(std::span<const double>(high.data(), 3));
  write_optional(json, "first_stamp_s", robot.first_ns);
  write_optional(json, "last_stamp_s", robot.last_ns);
  json.field("stamp_unit", robot.first_ns ? std::optional<std::string_view>(robot.stamp_unit) : std::nullopt);
  json.field("flattest_axis", flattest_axis(robot)).field("lengths_look_metric", lengths_metric);
  json.field("likely_submaps", robot.likely_submaps).field("first_cloud_points", robot.first_points);
  json.field("first_cloud_dropped", robot.first_dropped).field("median_range_m", robot.median_range_m).close();
}

std::string as_json(const Mission& mission, const Inspection& inspection) {
  JsonWriter json;
  json.open_object().field("schema", "kilter.info/1").key("sources").open_list();
  for (const SourceSummary& source : mission.sources) {
    json.open_object(JsonWriter::Layout::kCompact).field("source", source.source).field("kind", source.kind);
    json.field("robots", source.robots).field("clouds", source.clouds).close();
  }
  json.close().key("robots").open_list();
  for (const RobotInspection& robot : inspection.robots) {
    write_robot(json, robot, are_lengths_metric(inspection, robot));
  }
  json.close().field("likely_submaps", inspection.likely_submaps);
  const auto& pairs = inspection.likely_pairs;
  json.field("likely_pairs", pairs ? std::optional(static_cast<double>(*pairs)) : std::nullopt);
  json.key("oddities").open_list();
  for (const Oddity& oddity : inspection.oddities) {
    json.open_object(JsonWriter::Layout::kCompact).field("code", oddity.code).field("robot", oddity.robot);
    json.field("found", oddity.found).field("try", way_out_of(oddity.code)).close();
  }
  json.close().key("notes").open_list();
  for (const std::string& note : mission.notes) json.value(note);
  return json.close().close().take();
}

std::string robot_as_text(const RobotInspection& robot, bool lengths_metric) {
  const Eigen::Vector3d low = robot.extent_world_m.min();
  const Eigen::Vector3d high = robot.extent_world_m.max();
  std::string text = fmt::format("{} ({})\n", printable(robot.name), robot.kind);
  if (robot.clouds_unread > 0) {
    text += fmt::format("  only the first {} of {} scans were looked at: unpacking takes long\n", robot.clouds_found,
                        robot.clouds_found + robot.clouds_unread);
  }
  const std::size_t all =
      robot.poses_are_a_trajectory ? robot.clouds_found : std::max(robot.clouds_found, robot.poses_found);
  text += fmt::format("  {}, {}; poses matched {} of {}\n",
                      counted(robot.clouds, robot.finished_submaps ? "finished submap" : "scan"),
                      points_in_words(robot), robot.clouds, all);
  text += fmt::format("  path {:.1f} m, likely {}; {}\n", robot.path_length_m, counted(robot.likely_submaps, "submap"),
                      stamps_in_words(robot));
  text += fmt::format("  poses x {:.1f} to {:.1f}, y {:.1f} to {:.1f}, z {:.1f} to {:.1f} m; {}\n", low.x(), high.x(),
                      low.y(), high.y(), low.z(), high.z(), frame_in_words(robot));
  if (robot.median_range_m) {
    text += fmt::format("  first cloud: {}, median range {:.1f} m, {} dropped (not finite or too far); {}\n",
                        counted(robot.first_points, "point"), *robot.median_range_m, robot.first_dropped,
                        lengths_metric ? "lengths look like metres" : "lengths do not look like metres");
  }
  return text;
}

std::string as_text(const Mission& mission, const Inspection& inspection) {
  std::string text;
  for (const SourceSummary& source : mission.sources) {
    text += fmt::format("{}: {}\n", printable(source.source, 1024), describe(source));
  }
  text += fmt::format("Likely {}", counted(inspection.likely_submaps, "submap"));
  if (inspection.likely_pairs) {
    text += fmt::format(", {} of them near enough to show the same place", counted(*inspection.likely_pairs, "pair"));
  }
  text += '\n';
  for (const RobotInspection& robot : inspection.robots) {
    text += robot_as_text(robot, are_lengths_metric(inspection, robot));
  }
  if (inspection.oddities.empty()) return text + "Nothing odd found\n";
  text += fmt::format("{} oddit{}, `kilter explain CODE` tells more\n", inspection.oddities.size(),
                      inspection.oddities.size() == 1 ? "y" : "ies");
  for (const Oddity& oddity : inspection.oddities) {
    text += fmt::format("  {}: {}: {}\n    try: {}\n", oddity.code, printable(oddity.robot),
                        printable(oddity.found, 1024), way_out_of(oddity.code));
  }
  return text;
}

int run_info(const InfoCommand& command) {
  const Expected<Settings> settings = read_settings(command.common);
  if (!settings) return print_error(settings.error());
  MissionOptions options;
  options.T_body_sensor = settings->T_body_sensor;
  options.glance = true;
  if (command.poses_folder) options.poses_folder = *command.poses_folder;
  const Expected<Mission> mission = open_mission(command.sources, options);
  if (!mission) return print_error(mission.error());
  const Expected<Inspection> inspection = inspect(*mission, settings->check.submap);
  if (!inspection) return print_error(inspection.error());
  if (!command.common.quiet) {
    for (const std::string& note : mission->notes) print_note(note);
  }
  const Expected<void> done =
      print_out(command.common.json ? as_json(*mission, *inspection) : as_text(*mission, *inspection));
  if (done) return kExitGood;
  print_error(done.error());
  return exit_status_of_output(done.error().code);
}

}  // namespace

void add_info_command(CLI::App& program, int& status) {
  const auto command = std::make_shared<InfoCommand>();
  CLI::App* app = program.add_subcommand("info", "what a source holds, and what is odd about it, before any work");
  app->add_option("SOURCE", command->sources, "a mission's folder, a robot's folder, or NAME=PATH")->required();
  app->add_option("--poses", command->poses_folder, "take DIR/ROBOT/poses.* instead of each robot's own poses")
      ->option_text("DIR");
  add_common_options(*app, command->common);
  app->callback([command, &status] { status = run_info(*command); });
}

}  // namespace kilter::app
