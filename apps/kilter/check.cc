// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <ctime>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/format.h>
#include <sys/resource.h>

#include "apps/kilter/available_memory.h"
#include "apps/kilter/commands.h"
#include "apps/kilter/common_options.h"
#include "apps/kilter/exit_status.h"
#include "apps/kilter/fine_voxels.h"
#include "apps/kilter/known_cuts.h"
#include "apps/kilter/output_folder.h"
#include "apps/kilter/own_files.h"
#include "apps/kilter/result_files.h"
#include "apps/kilter/signals.h"
#include "apps/kilter/source_clouds.h"
#include "apps/kilter/terminal.h"
#include "apps/kilter/unused_keys.h"
#include "apps/kilter/word_option.h"
#include "kilter/io/file.h"
#include "kilter/io/find_oddities.h"
#include "kilter/io/inspection.h"
#include "kilter/io/mission.h"
#include "kilter/io/temporary_file.h"
#include "kilter/io/usable_points.h"
#include "kilter/pipeline/check.h"
#include "kilter/report/constraints_g2o.h"
#include "kilter/report/result_json.h"
#include "kilter/report/summary.h"

namespace kilter::app {
namespace {

struct CheckCommand {
  CommonOptions common;
  std::vector<std::string> sources;
  std::string output_folder = "kilter-out";
  std::optional<std::string> poses_folder;
  std::optional<std::string> cuts;
  std::optional<std::string> submap_poses;
  bool seed_preset = false;
  bool maps = false;
  G2oDialect g2o_dialect = G2oDialect::kG2o;
  FailOn fail_on = FailOn::kUndetermined;
};

// What is to be checked, read and found fit before any work begins.
struct Job {
  Settings settings;
  Mission mission;
  Cuts cuts;
  std::size_t memory_bytes = 0;  // 0 = no limit
  std::vector<Oddity> oddities;  // with which no answer means much
};

// Of what `info` finds odd, that which makes nonsense of a map.
constexpr std::array kSpoilsAll = std::to_array<std::string_view>(
    {"camera-frame", "millimetres", "time-jump", "pose-jump", "no-motion", "far-robot", "no-turns", "tumbles",
     "stamps-differ", "clouds-in-world", "inverse-poses", "transposed-rotations", "scalar-first", "swapped-poses",
     "shifted-poses", "turned-sensor", "mirrored-poses", "other-axes"});

// What cannot be looked at is told when it is read.
std::vector<Oddity> find_spoilers(const Mission& mission, const SubmapOptions& options) {
  Expected<Inspection> inspection = inspect(mission, options);
  if (!inspection) return {};
  std::vector<Oddity> found = std::move(inspection->oddities);
  std::erase_if(found, [](const Oddity& oddity) {
    return std::find(kSpoilsAll.begin(), kSpoilsAll.end(), oddity.code) == kSpoilsAll.end();
  });
  return found;
}

Expected<void> check_map_names(const CheckCommand& command, const Mission& mission) {
  for (const RobotLog& robot : mission.robots) {
    if (command.maps && robot.name == "global") {
      return fail(ErrorCode::kUsage, "--maps writes maps/global.ply for all robots, and a robot is called global", {},
                  "name that robot otherwise: NAME=PATH");
    }
  }
  return {};
}

Expected<Job> open_job(const CheckCommand& command) {
  Job job;
  const Expected<std::size_t> memory = parse_memory(command.common.memory);
  if (!memory) return pass_up(memory.error());
  job.memory_bytes = memory_budget(*memory);
  Expected<Settings> settings = read_settings(command.common, command.seed_preset);
  if (!settings) return pass_up(settings.error());
  job.settings = *std::move(settings);
  MissionOptions options;
  options.T_body_sensor = job.settings.T_body_sensor;
  if (command.poses_folder) options.poses_folder = *command.poses_folder;
  Expected<Mission> mission = open_mission(command.sources, options);
  if (!mission) return pass_up(mission.error());
  job.mission = *std::move(mission);
  if (auto fit = check_map_names(command, job.mission); !fit) return pass_up(fit.error());
  for (const RobotLog& robot : job.mission.robots) {
    if (auto usable = check_usable(robot); !usable) return pass_up(usable.error());
  }
  Expected<Cuts> cuts =
      place_submaps(job.mission, job.settings.check, command.cuts, command.submap_poses, command.poses_folder);
  if (!cuts) return pass_up(cuts.error());
  job.cuts = *std::move(cuts);
  job.oddities = find_spoilers(job.mission, job.settings.check.submap);
  return job;
}

Expected<Result> run_job(const CheckCommand& command, const Job& job) {
  Progress progress(command.common.progress_style());
  CheckRun run;
  run.threads = command.common.jobs;
  run.cancelled = &stop_flag();
  const std::unique_ptr<SpillSpace> spill = temporary_file_in(folder_for_large_temporary_files());
  run.memory_bytes = job.memory_bytes;
  run.spill = spill.get();
  run.fuse_maps = command.maps;
  run.draw_picture = true;
  run.progress = [&progress](std::string_view stage, std::size_t done, std::size_t total) {
    progress.update(stage, done, total);
  };
  Expected<Result> result = check(job.mission.robots, job.settings.check, job.cuts, run);
  // Cuts and scans contradict each other; the scans were counted without them.
  if (!result && result.error().code == ErrorCode::kCountMismatch && result.error().where.empty() && command.cuts) {
    result.error().where = printable(*command.cuts);
  }
  return result;
}

ConfigEcho config_echo(Job& job) {
  ConfigEcho config;
  config.options = fields(job.settings.check);
  for (const RobotLog& robot : job.mission.robots) {
    for (const std::string& key : {robot.name, std::string()}) {
      const auto found = job.settings.T_body_sensor.find(key);
      if (found == job.settings.T_body_sensor.end()) continue;
      config.T_body_sensor[robot.name] = found->second;
      break;
    }
  }
  return config;
}

std::string date_now() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  return {text, std::strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%SZ", &utc)};
}

RunInfo run_info(const CheckCommand& command) {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  constexpr std::size_t kLinuxUnit = 1024;  // ru_maxrss
  return {command.sources,     command.poses_folder,
          command.cuts,        command.submap_poses,
          command.common.jobs, static_cast<std::size_t>(usage.ru_maxrss) * kLinuxUnit,
          date_now()};
}

// The maps that --maps writes: of all robots together, then each one's.
std::vector<std::string> map_names(const CheckCommand& command, const Mission& mission) {
  if (!command.maps) return {};
  std::vector<std::string> names = {"global"};
  for (const RobotLog& robot : mission.robots) names.push_back(robot.name);
  return names;
}

// One line for a robot all of whose submaps are bare, instead of one for each of them.
void print_notes_on_bare_submaps(const Result& result) {
  std::map<std::string, std::vector<std::string>> bare;
  for (const SubmapSummary& submap : result.submaps) {
    if (submap.occupied == 0) bare[submap.robot].push_back(printable(submap.name));
  }
  for (const RobotSummary& robot : result.robots) {
    const std::vector<std::string>& submaps = bare[robot.name];
    if (submaps.size() > 1 && std::ssize(submaps) == robot.submaps) {
      print_note(fmt::format("robot {}: none of its {} submaps holds a surface", robot.name, submaps.size()));
      continue;
    }
    for (const std::string& submap : submaps) print_note(fmt::format("submap {} holds no surface at all", submap));
  }
}

// What is no error, but a person should know.
void print_notes(const CheckCommand& command, const Result& result) {
  if (command.common.quiet) return;
  print_notes_on_bare_submaps(result);
  std::map<std::string, std::size_t> dropped;
  for (const SubmapSummary& submap : result.submaps) dropped[submap.robot] += submap.dropped_points;
  for (const auto& [robot, points] : dropped) {
    if (points == 0) continue;
    print_note(fmt::format("robot {}: {} points were left out, being not finite or too far away", robot, points));
  }
  std::error_code error;
  const std::filesystem::path maps = std::filesystem::path(command.output_folder) / "maps";
  if (command.maps || !std::filesystem::exists(maps, error)) return;
  print_note(shown(maps) + " is from an earlier run; --maps makes it anew");
}

Expected<void> present(const CheckCommand& command, const Job& job, const Result& result, const std::string& json) {
  if (command.common.json) return print_out(json);
  SummaryOptions options;
  options.tolerance_m = job.settings.check.judge.tolerance_m;
  options.papers_test = job.settings.check.judge.method == JudgeMethod::kGamma;
  options.colour = wants_colour(command.common.no_color);
  options.output_folder = command.output_folder;
  options.poses = command.poses_folder;
  for (const SourceSummary& source : job.mission.sources) options.sources.push_back(describe(source));
  for (const Oddity& oddity : job.oddities) {
    if (options.odd.empty()) options.odd = fmt::format("{} of robot {}", oddity.code, printable(oddity.robot));
  }
  return print_out(summary(result, options));
}

int refuse_output(const Error& error) {
  print_error(error);
  return exit_status_of_output(error.code);
}

// What a person should know of the sources before any work.
void print_notes_before(const Job& job) {
  for (const std::string& note : job.mission.notes) print_note(note);
  for (const std::string& note : notes_on_cells(job.mission, job.settings.check.submap.occupancy.resolution_m)) {
    print_note(note);
  }
  for (const GivenTwice& twice : robots_given_twice(job.mission.robots)) {
    const std::string later = printable(job.mission.robots[twice.later].name);
    const std::string earlier = printable(job.mission.robots[twice.earlier].name);
    print_note(twice.same_places
                   ? fmt::format("robot {}: its poses and clouds are those of {}; that the two agree proves nothing",
                                 later, earlier)
                   : fmt::format("robot {}: its clouds are those of {}, under other poses; how these differ is all "
                                 "that the two can tell",
                                 later, earlier));
  }
  for (const Oddity& oddity : job.oddities) {
    print_note(fmt::format("robot {}: {}, which is odd ({}): {}", printable(oddity.robot),
                           printable(oddity.found, 1024), oddity.code, way_out_of(oddity.code)));
  }
  if (const auto note = note_on_unused_keys(job.mission, job.settings.check)) print_note(*note);
  for (const std::string& note : notes_on_keys_of_other_methods(job.settings.check)) print_note(note);
  if (const auto note = note_on_fine_voxels(job.settings.check.submap.occupancy)) print_note(*note);
  if (const auto note = note_on_fine_tolerance(job.settings.check)) print_note(*note);
  for (const RobotLog& robot : job.mission.robots) {
    if (!robot.finished_submaps || robot.read_cells) continue;
    print_note(
        fmt::format("robot {}: its submaps are points, which say nothing of free space; evidence that needs it "
                    "is left out, and a submap that is bent inside may go unseen",
                    robot.name));
  }
}

int run_check(const CheckCommand& command) {
  Expected<Job> job = open_job(command);
  if (!job) return print_error(job.error());
  const std::vector<std::filesystem::path> names = result_file_names(map_names(command, job->mission));
  catch_stop_signals();
  if (auto fit = probe_output_folder(command.output_folder, names); !fit) return refuse_output(fit.error());
  if (auto fit = check_apart_from_clouds(command.output_folder, names, command.sources, job->mission); !fit) {
    return print_error(fit.error());
  }
  if (auto fit = check_results_replaceable(command.output_folder, names); !fit) return print_error(fit.error());
  if (!command.common.quiet) print_notes_before(*job);
  const Expected<Result> result = run_job(command, *job);
  if (!result) return print_error(result.error());
  if (stop_flag()) return print_error(stopped());
  const ConfigEcho config = config_echo(*job);
  const std::string json = result_json(*result, config, run_info(command));
  print_notes(command, *result);
  const ResultFormats formats = {json, config, job->settings.check.judge.tolerance_m, command.g2o_dialect};
  std::vector<std::string> notes;
  const std::vector<OutputFile> files = result_files(*result, formats, notes);
  for (const std::string& note : notes) {
    if (!command.common.quiet) print_note(note);
  }
  // Somebody may have put something there since.
  if (auto fit = check_results_replaceable(command.output_folder, names); !fit) return print_error(fit.error());
  if (auto done = write_output_folder(command.output_folder, files); !done) return refuse_output(done.error());
  if (auto done = present(command, *job, *result, json); !done) return refuse_output(done.error());
  return exit_status(result->system.state, command.fail_on);
}

}  // namespace

void add_check_command(CLI::App& program, int& status) {
  const auto command = std::make_shared<CheckCommand>();
  CLI::App* app = program.add_subcommand("check", "find where a map disagrees with itself");
  app->add_option("SOURCE", command->sources, "a mission's folder, a robot's folder, or NAME=PATH")->required();
  app->add_option("-o,--output", command->output_folder, "folder for the results")->option_text("OUT (kilter-out)");
  app->add_option("--poses", command->poses_folder, "take DIR/ROBOT/poses.* instead of each robot's own poses")
      ->option_text("DIR");
  app->add_option("--cuts", command->cuts, "cut submaps at the same scans as this result, so that two compare")
      ->option_text("RESULT");
  app->add_option("--submap-poses", command->submap_poses,
                  "move submaps to where this pose graph has them, say what an optimiser made of constraints.g2o; "
                  "scans need the --cuts of that result")
      ->option_text("FILE.g2o");
  add_word_option<bool>(*app, "--preset", command->seed_preset, {{"seed", true}},
                        "start from the paper's method and nothing else")
      ->option_text("seed");
  app->add_flag("--maps", command->maps,
                "also write each robot's fused map and the global one; they take memory beyond --memory");
  add_word_option<FailOn>(
      *app, "--fail-on", command->fail_on,
      {{"inconsistent", FailOn::kInconsistent}, {"undetermined", FailOn::kUndetermined}, {"never", FailOn::kNever}},
      "which verdicts give a status other than 0")
      ->option_text("inconsistent|undetermined|never (undetermined: both)");
  add_word_option<G2oDialect>(*app, "--g2o-dialect", command->g2o_dialect,
                              {{"g2o", G2oDialect::kG2o}, {"gtsam", G2oDialect::kGtsam}, {"ceres", G2oDialect::kCeres}},
                              "whose reading of its numbers constraints.g2o is written for")
      ->option_text("g2o|gtsam|ceres (g2o)");
  add_common_options(*app, command->common);
  app->callback([command, &status] { status = run_check(*command); });
}

}  // namespace kilter::app
