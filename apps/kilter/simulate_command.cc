// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <charconv>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <system_error>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/format.h>

#include "apps/kilter/commands.h"
#include "apps/kilter/common_options.h"
#include "apps/kilter/exit_status.h"
#include "apps/kilter/signals.h"
#include "apps/kilter/simulate.h"
#include "apps/kilter/terminal.h"
#include "apps/kilter/whole_option.h"
#include "apps/kilter/word_option.h"
#include "kilter/base/parallel.h"
#include "kilter/report/json_writer.h"

namespace kilter::app {
namespace {

struct SimulateCommand {
  CommonOptions common;
  SimulateRequest request;
};

// As CLI::Range, which takes NaN for a number of every range.
CLI::Validator within(double low, double high) {
  const auto check = [low, high](const std::string& text) {
    double number = 0.0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), number);
    const bool is_number = status == std::errc() && end == text.data() + text.size();
    if (is_number && number >= low && number <= high) return std::string();
    return fmt::format("expected a number from {} to {}, found \"{}\"", low, high, printable(text, 80));
  };
  return {check, ""};
}

std::string robot_of(const SimulateSummary& summary, const Fault& fault) {
  return summary.robots[static_cast<std::size_t>(fault.robot)];
}

std::string scene_list() {
  std::string text = "Scenes:\n";
  for (const SceneInfo& scene : scene_catalog()) text += fmt::format("  {:<16} {}\n", scene.name, scene.about);
  return text;
}

std::string as_json(const SimulateSummary& summary) {
  JsonWriter json;
  json.open_object().field("schema", "kilter.simulate/1").key("robots").open_list(JsonWriter::Layout::kCompact);
  for (const std::string& robot : summary.robots) json.value(robot);
  json.close().field("scans", summary.scans).key("faults").open_list();
  for (const Fault& fault : summary.faults) {
    json.open_object(JsonWriter::Layout::kCompact)
        .field("kind", to_string(fault.kind))
        .field("robot", robot_of(summary, fault));
    json.field("scan", fault.scan).field("size_m", fault.size_m).field("size_rad", fault.size_rad).close();
  }
  return json.close().close().take();
}

std::string as_text(const SimulateSummary& summary, const std::string& folder) {
  std::string text = fmt::format("{} scans of {} robot{} in {}/mission, the truth in {}/truth\n", summary.scans,
                                 summary.robots.size(), summary.robots.size() == 1 ? "" : "s", folder, folder);
  for (const Fault& fault : summary.faults) {
    text += fmt::format("  {}: robot {} at scan {}, {:.2f} m, {:.3f} rad\n", to_string(fault.kind),
                        robot_of(summary, fault), fault.scan, fault.size_m, fault.size_rad);
  }
  return text;
}

int run_simulate(SimulateCommand& command) {
  // A world takes no keys of `check`, but a wrong one must not pass unnoticed.
  if (const Expected<Settings> keys = read_settings(command.common); !keys) {
    print_error(keys.error());
    return exit_status(keys.error().code);
  }
  SimulateRequest& request = command.request;
  request.writer.scene = request.scene;
  request.writer.seed = request.options.seed;
  catch_stop_signals();
  Progress progress(command.common.progress_style());
  // Embree sets TBB up for what processors there are, and TBB complains where more threads are asked for later.
  RunContext run{std::min(command.common.jobs, available_processors()), &stop_flag(), {}};
  run.progress = [&progress](std::size_t done, std::size_t total) { progress.update("scans", done, total); };
  const Expected<SimulateSummary> summary = simulate(request, run);
  progress.finish();
  if (!summary) {
    print_error(summary.error());
    // It reads no input: whatever the system refuses, it refuses to our output.
    const bool is_output = exit_status(summary.error().code) == kExitInput;
    return is_output ? exit_status_of_output(summary.error().code) : exit_status(summary.error().code);
  }
  for (const std::string& note : summary->notes) {
    if (!command.common.quiet) print_note(note);
  }
  const std::string folder = printable(request.writer.folder.native(), 200);
  const Expected<void> done = print_out(command.common.json ? as_json(*summary) : as_text(*summary, folder));
  if (done) return kExitGood;
  print_error(done.error());
  return exit_status_of_output(done.error().code);
}

}  // namespace

void add_simulate_command(CLI::App& program, int& status) {
  const auto command = std::make_shared<SimulateCommand>();
  SimulateRequest& request = command->request;
  CLI::App* app = program.add_subcommand("simulate", "make a mission whose truth and faults are known");
  app->add_option("SCENE", request.scene, "kind of world")->required();
  app->add_option("-o,--output", request.writer.folder, "folder for mission/ and truth/")
      ->option_text("DIR REQUIRED")
      ->required();
  add_whole_option<std::uint64_t>(*app, "--seed", request.options.seed, 0, std::numeric_limits<std::uint64_t>::max(),
                                  "another seed, another world (1)");
  add_whole_option(*app, "--robots", request.options.robots, 1, static_cast<int>(kRobotNames.size()),
                   "how many, 1 to 5 (2); the paper's scenes have two");
  app->add_option("--scale", request.options.scale,
                  "size of the world, as a factor (1); the paper's scenes have their own")
      ->option_text("FACTOR")
      ->check(within(0.5, 10.0));
  app->add_option("--fault", request.faults, "KIND[:ROBOT[:SIZE_M[:AT]]], or none; may be repeated")
      ->option_text("FAULT")
      ->allow_extra_args(false);
  add_word_option<int>(*app, "--beams", request.beams, {{"16", 16}, {"32", 32}, {"64", 64}}, "rings of the lidar")
      ->option_text("16|32|64 (16)");
  add_whole_option(*app, "--columns", request.columns, 36, 7200, "points of a ring (1800)");
  app->add_option("--range-noise", request.range_noise_m, "standard deviation of a range (0.02 m)")
      ->option_text("M")
      ->check(within(0.0, 1.0));
  app->add_option("--motion-residual", request.motion_residual, "share of the motion that is left undistorted (0.02)")
      ->option_text("SHARE")
      ->check(within(0.0, 1.0));
  app->add_option("--scan-step", request.scan_step_m, "way between two scans, from 0.05 m on (the scene's own)")
      ->option_text("M")
      ->check(within(0.05, 100.0));  // the routes' knots are up to 0.05 m apart
  add_word_option<ScanFormat>(*app, "--format", request.writer.format,
                              {{"bin", ScanFormat::kBin}, {"pcd", ScanFormat::kPcd}}, "of the scans")
      ->option_text("bin|pcd (bin)");
  app->add_flag("--replace", request.writer.replace,
                "put the new mission in the place of an earlier one of simulate's in DIR, once it is whole");
  add_common_options(*app, command->common);
  app->footer(scene_list());
  app->callback([command, &status] { status = run_simulate(*command); });
}

}  // namespace kilter::app
