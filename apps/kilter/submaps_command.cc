// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/format.h>

#include "apps/kilter/available_memory.h"
#include "apps/kilter/commands.h"
#include "apps/kilter/common_options.h"
#include "apps/kilter/exit_status.h"
#include "apps/kilter/fine_voxels.h"
#include "apps/kilter/known_cuts.h"
#include "apps/kilter/output_folder.h"
#include "apps/kilter/signals.h"
#include "apps/kilter/source_clouds.h"
#include "apps/kilter/submap_writer.h"
#include "apps/kilter/terminal.h"
#include "apps/kilter/unused_keys.h"
#include "apps/kilter/word_option.h"
#include "kilter/io/file.h"
#include "kilter/io/mission.h"
#include "kilter/io/sources/robot_folder.h"
#include "kilter/io/usable_points.h"
#include "kilter/pipeline/submap_store.h"
#include "kilter/report/json_writer.h"
#include "kilter/report/text_lines.h"
#include "kilter/submap/build_submaps.h"

namespace kilter::app {
namespace {

struct SubmapsCommand {
  CommonOptions common;
  std::vector<std::string> sources;
  std::string output_folder;
  std::optional<std::string> poses_folder;
  std::optional<std::string> cuts;
  std::optional<std::string> submap_poses;
  SubmapFormat format = SubmapFormat::kOt;
  bool replace = false;
};

// What is to be written, read and found fit before any work begins.
struct Job {
  Settings settings;
  Mission mission;
  Cuts cuts;
  std::size_t memory_bytes = 0;
  std::size_t growing_bytes = 0;  // what maps are held against while they are made
};

struct WrittenRobot {
  std::string name;
  std::size_t submaps = 0;
  std::size_t occupied = 0;
  std::size_t bytes = 0;
};

// An error and whose it is: what the system refuses to our output is no fault of the input.
struct Failure {
  Error error;
  bool is_output = false;
};

template <typename T>
using Done = tl::expected<T, Failure>;

tl::unexpected<Failure> failed(Error error, bool is_output = false) {
  return tl::unexpected<Failure>(Failure{std::move(error), is_output});
}

std::filesystem::path graph_of(const SubmapsCommand& command) {
  return std::filesystem::path(command.output_folder) / kPoseGraph;
}

std::filesystem::path folder_of(const SubmapsCommand& command, const RobotLog& robot) {
  return std::filesystem::path(command.output_folder) / robot.name;
}

Done<Job> open_job(const SubmapsCommand& command) {
  Job job;
  const Expected<std::size_t> memory = parse_memory(command.common.memory);
  if (!memory) return failed(memory.error());
  job.memory_bytes = *memory;
  job.growing_bytes = memory_budget(*memory);
  Expected<Settings> settings = read_settings(command.common);
  if (!settings) return failed(settings.error());
  job.settings = *std::move(settings);
  MissionOptions options;
  options.T_body_sensor = job.settings.T_body_sensor;
  if (command.poses_folder) options.poses_folder = *command.poses_folder;
  Expected<Mission> mission = open_mission(command.sources, options);
  if (!mission) return failed(mission.error());
  job.mission = *std::move(mission);
  for (const RobotLog& robot : job.mission.robots) {
    if (auto usable = check_usable(robot); !usable) return failed(usable.error());
  }
  Expected<Cuts> cuts =
      place_submaps(job.mission, job.settings.check, command.cuts, command.submap_poses, command.poses_folder);
  if (!cuts) return failed(cuts.error());
  job.cuts = *std::move(cuts);
  return job;
}

// Whether all of it can be written, and nothing of others is harmed.
Done<void> check_output(const SubmapsCommand& command, const Job& job) {
  if (auto fit = probe_output_folder(command.output_folder, {kPoseGraph}); !fit) return failed(fit.error(), true);
  std::vector<std::filesystem::path> names = {kPoseGraph};
  for (const RobotLog& robot : job.mission.robots) {
    if (robot.name == kPoseGraph) {
      return failed({ErrorCode::kUsage, "the pose graph of all submaps gets that name, and a robot has it",
                     shown(folder_of(command, robot)), "call the robot otherwise: NAME=PATH"});
    }
    names.push_back(std::filesystem::path(robot.name) / submap_file(0, command.format));
  }
  if (auto fit = check_apart_from_clouds(command.output_folder, names, command.sources, job.mission); !fit) {
    return failed(fit.error());
  }
  if (is_robot_folder(command.output_folder)) {
    return failed({ErrorCode::kUsage, "this is a robot's own folder, below which check looks for no other robots",
                   "-o " + shown(command.output_folder), "name another folder with -o"});
  }
  for (const RobotLog& robot : job.mission.robots) {
    if (auto fit = check_robot_folder(folder_of(command, robot), command.replace); !fit) {
      return failed(fit.error(), fit.error().code != ErrorCode::kUsage);
    }
  }
  if (auto fit = check_pose_graph(graph_of(command), command.replace); !fit) return failed(fit.error());
  if (auto fit = probe_output_folder(command.output_folder, names); !fit) return failed(fit.error(), true);
  return {};
}

Expected<std::vector<Submap>> build(const Job& job, std::size_t number, const SubmapsCommand& command,
                                    Progress& progress) {
  const RobotLog& robot = job.mission.robots[number];
  const std::string stage = "submaps of " + robot.name;
  RunContext run{command.common.jobs, &stop_flag(), {}};
  run.memory_bytes = job.growing_bytes;
  run.progress = [&](std::size_t done, std::size_t total) { progress.update(stage, done, total); };
  const auto cut = job.cuts.find(robot.name);
  const auto ranges = cut == job.cuts.end() ? std::nullopt : std::optional(cut->second);
  Expected<std::vector<Submap>> submaps =
      build_submaps(robot, static_cast<int>(number), job.settings.check.submap, run, ranges);
  if (!submaps) return submaps;
  std::size_t held = 0;
  for (const Submap& submap : *submaps) held += submap.map.bytes();
  if (job.memory_bytes == 0 || held <= job.memory_bytes) return submaps;
  return pass_up(exceeds_memory(fmt::format("the submaps of {} need", printable(robot.name)), held, job.memory_bytes));
}

// When each submap began, where the source tells.
std::vector<std::int64_t> stamps_of(const RobotLog& robot, const std::vector<Submap>& submaps) {
  std::vector<std::int64_t> stamps_ns;
  if (robot.stamps_ns.size() != robot.T_world_cloud.size()) return stamps_ns;
  for (std::size_t i = 0; i < submaps.size(); ++i) {
    stamps_ns.push_back(robot.stamps_ns[submaps[i].scans ? submaps[i].scans->first : i]);
  }
  return stamps_ns;
}

// What is replaced, relative to the output folder, in which others may have written since the work began.
Expected<std::vector<std::filesystem::path>> earlier_files(const SubmapsCommand& command, const Job& job) {
  std::vector<std::filesystem::path> earlier;
  for (const RobotLog& robot : job.mission.robots) {
    const std::filesystem::path folder = folder_of(command, robot);
    if (auto fit = check_robot_folder(folder, command.replace); !fit) return pass_up(fit.error());
    const auto names = earlier_submaps(folder);
    if (!names) return pass_up(names.error());
    for (const std::filesystem::path& name : *names) earlier.push_back(robot.name / name);
  }
  if (auto fit = check_pose_graph(graph_of(command), command.replace); !fit) return pass_up(fit.error());
  std::error_code error;
  if (std::filesystem::exists(graph_of(command), error)) earlier.emplace_back(kPoseGraph);
  return earlier;
}

// Robots that an earlier run left there, or that somebody put there: one `check` of the folder reads them all.
std::vector<std::string> find_others(const SubmapsCommand& command, const Job& job) {
  const std::filesystem::path folder = command.output_folder;
  std::vector<std::string> others;
  for (const std::string& name : list_folder(folder).value_or(std::vector<std::string>())) {
    const bool is_ours = std::any_of(job.mission.robots.begin(), job.mission.robots.end(),
                                     [&](const RobotLog& robot) { return robot.name == name; });
    if (!is_ours && !name.starts_with('.') && is_robot_folder(folder / name)) others.push_back(name);
  }
  return others;
}

// Robot by robot, so that no more than one's submaps are in memory; what was there before goes when all are written.
Done<std::vector<WrittenRobot>> write_all(const SubmapsCommand& command, const Job& job, bool with_graph) {
  Progress progress(command.common.progress_style());
  Expected<StagingFolder> staging = StagingFolder::make_in(command.output_folder);
  if (!staging) return failed(staging.error(), true);
  std::vector<std::filesystem::path> names;
  std::vector<WrittenRobot> written;
  std::vector<SubmapSummary> vertices;
  for (std::size_t number = 0; number < job.mission.robots.size(); ++number) {
    const RobotLog& robot = job.mission.robots[number];
    const Expected<std::vector<Submap>> submaps = build(job, number, command, progress);
    if (!submaps) return failed(submaps.error());
    if (stop_flag()) return failed(stopped());
    WrittenRobot& summary = written.emplace_back(WrittenRobot{robot.name, submaps->size(), 0, 0});
    const Expected<WaitingSubmaps> waiting = write_submaps(*staging, robot.name, *submaps, stamps_of(robot, *submaps),
                                                           command.format, job.settings.check.submap.occupancy);
    if (!waiting) return failed(waiting.error(), waiting.error().code != ErrorCode::kUnsupported);
    names.insert(names.end(), waiting->names.begin(), waiting->names.end());
    summary.bytes = waiting->bytes;
    for (const Submap& submap : *submaps) {
      summary.occupied += submap.map.voxels().size();
      SubmapSummary& vertex = vertices.emplace_back();
      vertex.id = {static_cast<int>(vertices.size()) - 1};
      vertex.name = submap.name;
      vertex.T_world_submap = submap.T_world_submap;
    }
  }
  if (with_graph) {
    names.emplace_back(kPoseGraph);
    if (auto done = staging->write(kPoseGraph, pose_graph_text(vertices)); !done) return failed(done.error(), true);
  }
  if (stop_flag()) return failed(stopped());
  const auto earlier = earlier_files(command, job);
  if (!earlier) return failed(earlier.error(), earlier.error().code != ErrorCode::kUsage);
  if (auto done = staging->publish(names, *earlier); !done) return failed(done.error(), true);
  return written;
}

std::string as_json(const SubmapsCommand& command, const std::vector<WrittenRobot>& robots) {
  JsonWriter json;
  json.open_object().field("schema", "kilter.submaps/1").field("folder", command.output_folder);
  json.field("format", extension_of(command.format)).key("robots").open_list();
  for (const WrittenRobot& robot : robots) {
    json.open_object(JsonWriter::Layout::kCompact).field("name", robot.name).field("submaps", robot.submaps);
    json.field("occupied", robot.occupied).field("bytes", robot.bytes).close();
  }
  return json.close().close().take();
}

std::string as_text(const SubmapsCommand& command, const std::vector<WrittenRobot>& robots) {
  std::string text;
  for (const WrittenRobot& robot : robots) {
    text += fmt::format("{}: {} submap{}, {} occupied voxels, {:.1f} MB\n", printable(robot.name), robot.submaps,
                        robot.submaps == 1 ? "" : "s", robot.occupied, static_cast<double>(robot.bytes) / 1e6);
  }
  const std::string folder = shown(std::filesystem::path(command.output_folder));
  return text + fmt::format("in {}; `kilter check {}` reads them\n", folder, shell_word(folder));
}

void print_notes(const SubmapsCommand& command, const Job& job) {
  if (command.common.quiet) return;
  for (const SourceSummary& source : job.mission.sources) {
    print_note(fmt::format("{}: {}", printable(source.source, 1024), describe(source)));
  }
  for (const std::string& note : job.mission.notes) print_note(note);
  for (const std::string& note : notes_on_cells(job.mission, job.settings.check.submap.occupancy.resolution_m)) {
    print_note(note);
  }
  if (const auto note = note_on_unused_keys(job.mission, job.settings.check)) print_note(*note);
  if (const auto note = note_on_fine_voxels(job.settings.check.submap.occupancy)) print_note(*note);
  if (command.format == SubmapFormat::kPcd || command.format == SubmapFormat::kPly) {
    print_note("points alone say nothing of free space, and verdicts lack that evidence; --format ot keeps it");
  }
}

void print_note_on_others(const SubmapsCommand& command, const std::vector<std::string>& others) {
  if (command.common.quiet || others.empty()) return;
  const std::string folder = shown(std::filesystem::path(command.output_folder));
  print_note(fmt::format("{} holds {} too, which {} not of this run and which `kilter check {}` reads with it", folder,
                         some_of(others), others.size() == 1 ? "is" : "are", shell_word(folder)));
  print_note(fmt::format("{} would lack what is not of this run, and is not there", shown(graph_of(command))));
}

int finish(const Failure& failure) {
  print_error(failure.error);
  return failure.is_output ? exit_status_of_output(failure.error.code) : exit_status(failure.error.code);
}

int run_submaps(const SubmapsCommand& command) {
  const Done<Job> job = open_job(command);
  if (!job) return finish(job.error());
  catch_stop_signals();
  if (auto fit = check_output(command, *job); !fit) return finish(fit.error());
  print_notes(command, *job);
  // A graph of a part of what `check` finds in the folder would fit nothing.
  const std::vector<std::string> others = find_others(command, *job);
  const Done<std::vector<WrittenRobot>> written = write_all(command, *job, others.empty());
  if (!written) return finish(written.error());
  print_note_on_others(command, others);
  const Expected<void> done = print_out(command.common.json ? as_json(command, *written) : as_text(command, *written));
  return done ? kExitGood : finish({done.error(), true});
}

}  // namespace

void add_submaps_command(CLI::App& program, int& status) {
  const auto command = std::make_shared<SubmapsCommand>();
  CLI::App* app = program.add_subcommand("submaps", "write the submaps that check would compare");
  app->add_option("SOURCE", command->sources, "a mission's folder, a robot's folder, or NAME=PATH")->required();
  app->add_option("-o,--output", command->output_folder, "folder for ROBOT/submaps/ and ROBOT/poses.tum")
      ->option_text("DIR REQUIRED")
      ->required();
  add_word_option<SubmapFormat>(
      *app, "--format", command->format,
      {{"ot", SubmapFormat::kOt}, {"bt", SubmapFormat::kBt}, {"pcd", SubmapFormat::kPcd}, {"ply", SubmapFormat::kPly}},
      "octrees with or without probabilities, or points")
      ->option_text("ot|bt|pcd|ply (ot)");
  app->add_option("--poses", command->poses_folder, "take DIR/ROBOT/poses.* instead of each robot's own poses")
      ->option_text("DIR");
  app->add_option("--cuts", command->cuts, "cut submaps at the same scans as this result of check")
      ->option_text("RESULT");
  app->add_option("--submap-poses", command->submap_poses,
                  "move submaps to where this pose graph has them; scans need the --cuts of its result")
      ->option_text("FILE.g2o");
  app->add_flag("--replace", command->replace, "replace submaps that an earlier run wrote");
  add_common_options(*app, command->common);
  app->callback([command, &status] { status = run_submaps(*command); });
}

}  // namespace kilter::app
