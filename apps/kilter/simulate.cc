// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <charconv>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/format.h>

#include "apps/kilter/commands.h"
#include "apps/kilter/common_options.h"
#include "apps/kilter/exit_status.h"
#include "apps/kilter/mission_writer.h"
#include "apps/kilter/output_folder.h"
#include "apps/kilter/signals.h"
#include "apps/kilter/terminal.h"
#include "kilter/io/file.h"
#include "kilter/simulation/scene.h"

namespace kilter::app {
namespace {

struct SimulateCommand {
  CommonOptions common;
  std::string scene;
  SceneOptions world;
  MissionWriterOptions writer;
  int beams = 16;
  double scan_step_m = 0.0;         // 0 = the scene's own
  std::vector<std::string> faults;  // empty = the scene's own
};

// Bad arguments of the library are bad usage of the command.
tl::unexpected<Error> bad_usage(Error error) {
  if (error.code == ErrorCode::kInvalidArgument) error.code = ErrorCode::kUsage;
  return pass_up(std::move(error));
}

std::vector<std::string> split(std::string_view text, char by) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0;;) {
    const std::size_t end = std::min(text.find(by, begin), text.size());
    parts.emplace_back(text.substr(begin, end - begin));
    if (end == text.size()) return parts;
    begin = end + 1;
  }
}

std::optional<double> number_between(const std::string& text, double low, double high) {
  double value = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if (!(value >= low && value <= high)) return std::nullopt;
  return value;
}

// "slip", "missed-closure:b:0.8", "slip:a:0.4:0.25".
Expected<FaultRequest> parse_fault(const std::string& text) {
  const auto refuse = [&text](const std::string& why) {
    return fail(ErrorCode::kUsage, fmt::format("fault \"{}\": {}", printable(text), why), {},
                "KIND[:ROBOT[:SIZE_M[:SHARE_OF_PATH]]], KIND one of slip, missed-closure, frame-offset, frame-drift, "
                "wrong-closure, mistaken-place; e.g. slip:a:0.4:0.6");
  };
  const std::vector<std::string> parts = split(text, ':');
  const std::optional<FaultKind> kind = fault_kind_from(parts[0]);
  if (!kind) return refuse("there is no such kind");
  if (parts.size() > 4) return refuse("more than four parts");
  FaultRequest fault;
  fault.kind = *kind;
  fault.robot = *kind == FaultKind::kFrameOffset || *kind == FaultKind::kFrameDrift ? 1 : 0;
  if (parts.size() > 1) {
    if (parts[1].size() != 1 || parts[1][0] < 'a' || parts[1][0] > 'e') return refuse("expected a robot from a to e");
    fault.robot = parts[1][0] - 'a';
  }
  if (parts.size() > 2) {
    const std::optional<double> size_m = number_between(parts[2], 0.001, 100.0);
    if (!size_m) return refuse("expected a size from 0.001 to 100 m");
    fault.size_m = *size_m;
  }
  if (parts.size() > 3) {
    const std::optional<double> share = number_between(parts[3], 0.0, 1.0);
    if (!share) return refuse("expected a share of the robot's path from 0 to 1");
    fault.at = *share;
    fault.from = std::min(fault.from, 0.5 * *share);
  }
  return fault;
}

Expected<void> plant_faults(const std::vector<std::string>& texts, Scene& scene) {
  if (texts.empty()) return {};
  scene.faults.clear();
  for (const std::string& text : texts) {
    if (text == "none") continue;
    const Expected<FaultRequest> fault = parse_fault(text);
    if (!fault) return pass_up(fault.error());
    scene.faults.push_back(*fault);
  }
  return {};
}

Expected<LidarModel> chosen_lidar(const SimulateCommand& command) {
  Expected<LidarModel> lidar = lidar_model(command.beams);
  if (!lidar) return bad_usage(lidar.error());
  const std::vector<OptionField> keys = lidar->fields();
  for (const std::string& setting : command.common.settings) {
    const std::string name = setting.substr(0, setting.find('='));
    const auto key =
        std::find_if(keys.begin(), keys.end(), [&](const OptionField& field) { return field.name == name; });
    if (key == keys.end() || name.size() == setting.size()) {
      std::vector<std::string> names;
      for (const OptionField& field : keys) names.push_back(field.name);
      return fail(ErrorCode::kConfig,
                  fmt::format("expected KEY=VALUE with a key of the lidar, found \"{}\"", printable(setting)), {},
                  fmt::format("{}", fmt::join(names, ", ")));
    }
    if (auto done = key->assign(setting.substr(name.size() + 1)); !done) return pass_up(done.error());
  }
  return lidar;
}

Expected<SimulatedMission> plan(const SimulateCommand& command) {
  if (!command.common.config_file.empty()) {
    return fail(ErrorCode::kUsage, "simulate takes no configuration file", {}, "--set KEY=VALUE sets the lidar's keys");
  }
  const Expected<LidarModel> lidar = chosen_lidar(command);
  if (!lidar) return pass_up(lidar.error());
  Expected<Scene> scene = make_scene(command.scene, command.world);
  if (!scene) return bad_usage(scene.error());
  if (command.scan_step_m > 0.0) scene->scan_step_m = command.scan_step_m;
  if (auto planted = plant_faults(command.faults, *scene); !planted) return pass_up(planted.error());
  Expected<SimulatedMission> mission = SimulatedMission::plan(*std::move(scene), *lidar, command.world.seed);
  if (!mission) return bad_usage(mission.error());
  return mission;
}

std::string summary(const SimulatedMission& mission, const MissionWriterOptions& writer) {
  std::string text;
  for (const SimulatedRobot& robot : mission.robots()) {
    text += fmt::format("robot {}: {} scans\n", robot.name, robot.stamp_s.size());
  }
  for (const Fault& fault : mission.faults()) {
    const auto name = [&](int robot) { return mission.robots()[static_cast<std::size_t>(robot)].name; };
    text += fmt::format("{}: robot {} at scan {} stands {:.2f} m and {:.1f} deg wrong against {}'s scan {}\n",
                        to_string(fault.kind), name(fault.robot), fault.scan, fault.size_m,
                        fault.size_rad * 57.29577951308232, name(fault.against_robot), fault.against_scan);
  }
  if (mission.faults().empty()) text += "no fault planted\n";
  return text + fmt::format("kilter check {}\n", shown(writer.folder / "mission"));
}

int run_simulate(SimulateCommand command) {
  command.writer.scene = command.scene;
  command.writer.seed = command.world.seed;
  const Expected<SimulatedMission> mission = plan(command);
  if (!mission) return print_error(mission.error());
  const auto refuse_output = [](const Error& error) {
    print_error(error);
    return error.code == ErrorCode::kUsage ? exit_status(error.code) : exit_status_of_output(error.code);
  };
  if (auto fit = probe_output_folder(command.writer.folder); !fit) return refuse_output(fit.error());
  catch_stop_signals();
  Progress progress(command.common.progress_style());
  RunContext run{.threads = command.common.jobs, .cancelled = &stop_flag()};
  run.progress = [&progress](std::size_t done, std::size_t total) { progress.update("scans", done, total); };
  const Expected<void> written = write_mission(*mission, command.writer, run);
  progress.finish();
  if (!written) return refuse_output(written.error());
  const bool silent = command.common.quiet && !command.common.json;
  const Expected<void> told = silent ? Expected<void>{}
                                     : print_out(command.common.json ? faults_json(*mission, command.writer)
                                                                     : summary(*mission, command.writer));
  return told ? static_cast<int>(kExitGood) : refuse_output(told.error());
}

std::string scenes_help() {
  std::string text = "Scenes:\n";
  for (const SceneInfo& scene : scene_catalog()) text += fmt::format("  {:<15} {}\n", scene.name, scene.about);
  text += "\nKeys for --set:\n";
  LidarModel lidar;
  for (const OptionField& key : lidar.fields())
    text += fmt::format("  {:<16} {} ({})\n", key.name, key.doc, key.text());
  return text;
}

}  // namespace

void add_simulate_command(CLI::App& program, int& status) {
  const auto command = std::make_shared<SimulateCommand>();
  CLI::App* app = program.add_subcommand("simulate", "make a mission whose truth and faults are known");
  app->add_option("SCENE", command->scene, "a world, see below")->required();
  app->add_option("-o,--output", command->writer.folder, "folder for mission/ and truth/")
      ->required()
      ->option_text("DIR");
  app->add_option("--seed", command->world.seed, "everything random follows from it")->option_text("N (1)");
  app->add_option("--robots", command->world.robots, "how many robots")->option_text("1..5 (2)");
  app->add_option("--scale", command->world.scale, "of the world's extent")->option_text("0.5..10 (1)");
  app->add_option("--beams", command->beams, "of the lidar")->option_text("16|32|64 (16)");
  app->add_option("--scan-step", command->scan_step_m, "path between two scans instead of the scene's own")
      ->option_text("METRES")
      ->check(CLI::Range(0.05, 100.0).description(""));
  app->add_option("--fault", command->faults, "plant this instead of the scene's own; may be repeated")
      ->option_text("none|KIND[:ROBOT[:SIZE_M[:SHARE]]]");
  const std::map<std::string, ScanFormat> formats = {{"bin", ScanFormat::kBin}, {"pcd", ScanFormat::kPcd}};
  app->add_option("--format", command->writer.format, "of the scans")
      ->option_text("bin|pcd (bin)")
      ->transform(CLI::CheckedTransformer(formats).description(""));
  app->add_flag("--replace", command->writer.replace, "remove a mission that is in the folder already");
  add_common_options(*app, command->common);
  app->footer(scenes_help());
  app->callback([command, &status] { status = run_simulate(*command); });
}

}  // namespace kilter::app
