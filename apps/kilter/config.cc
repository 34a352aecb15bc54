// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <memory>
#include <string>
#include <string_view>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/format.h>

#include "apps/kilter/commands.h"
#include "apps/kilter/common_options.h"
#include "apps/kilter/exit_status.h"
#include "apps/kilter/terminal.h"
#include "apps/kilter/word_option.h"
#include "kilter/report/json_writer.h"

namespace kilter::app {
namespace {

struct ConfigCommand {
  CommonOptions common;
  bool seed_preset = false;
};

constexpr std::string_view kSensorDoc =
    "Where the poses are the vehicle's: the sensor's place on it, x y z qx qy qz qw. For one robot: "
    "T_body_sensor.NAME.";

std::string range_of(const OptionField& option) {
  if (option.kind == OptionField::Kind::kBoolean) return "true or false";
  if (option.kind == OptionField::Kind::kChoice) return fmt::format("{}", fmt::join(option.choices, " | "));
  std::string unit(unit_name(option.unit));
  if (!unit.empty()) unit.insert(0, " ");
  if (std::isinf(option.high)) return std::isinf(option.low) ? "any" + unit : fmt::format(">= {}{}", option.low, unit);
  if (std::isinf(option.low)) return fmt::format("<= {}{}", option.high, unit);
  return fmt::format("{} to {}{}", option.low, option.high, unit);
}

// The value as TOML: words in quotes.
std::string value_of(const OptionField& option) {
  return option.kind == OptionField::Kind::kChoice ? '"' + option.text() + '"' : option.text();
}

// A configuration file that `--config` reads back: each key below its meaning and range.
std::string as_toml(Settings& settings) {
  std::string text;
  for (const OptionField& option : fields(settings.check)) {
    text += fmt::format("# {} [{}]{}\n{} = {}\n\n", option.doc, range_of(option),
                        option.paper.empty() ? "" : fmt::format(" (the paper's {})", option.paper), option.name,
                        value_of(option));
  }
  text += fmt::format("# {}\n", kSensorDoc);
  if (settings.T_body_sensor.empty()) text += "# T_body_sensor = [0, 0, 0, 0, 0, 0, 1]\n";
  // The key cannot have a value for all robots and names of some behind it: "" is all there.
  const bool for_all_alone = settings.T_body_sensor.size() == 1 && settings.T_body_sensor.contains("");
  for (const auto& [robot, pose] : settings.T_body_sensor) {
    JsonWriter numbers;
    text += fmt::format("{}{} = {}", kSensorKey, for_all_alone ? std::string() : '.' + json_string(robot),
                        numbers.value(pose).take());
  }
  return text;
}

std::string as_json(Settings& settings) {
  JsonWriter json;
  json.open_object();
  for (const OptionField& option : fields(settings.check)) {
    json.key(option.name).open_object(JsonWriter::Layout::kCompact).key("value");
    switch (option.kind) {
      case OptionField::Kind::kReal:
        json.value(*option.real);
        break;
      case OptionField::Kind::kInteger:
        json.value(*option.integer);
        break;
      case OptionField::Kind::kBoolean:
        json.value(*option.boolean);
        break;
      case OptionField::Kind::kChoice:
        json.value(option.get_choice());
        break;
    }
    json.field("unit", unit_name(option.unit)).field("range", range_of(option));
    json.field("doc", option.doc).field("paper", option.paper).close();
  }
  json.key(kSensorKey).open_object(JsonWriter::Layout::kCompact);
  for (const auto& [robot, pose] : settings.T_body_sensor) json.field(robot, pose);
  return json.close().close().take();
}

int show_config(const ConfigCommand& command) {
  Expected<Settings> settings = read_settings(command.common, command.seed_preset);
  if (!settings) return print_error(settings.error());
  const Expected<void> done = print_out(command.common.json ? as_json(*settings) : as_toml(*settings));
  if (done) return kExitGood;
  print_error(done.error());
  return exit_status_of_output(done.error().code);
}

}  // namespace

void add_config_command(CLI::App& program, int& status) {
  const auto command = std::make_shared<ConfigCommand>();
  CLI::App* app = program.add_subcommand("config", "the keys that change what kilter does");
  app->require_subcommand(1);
  CLI::App* show = app->add_subcommand("show",
                                       "every key with its value, unit, range and meaning, as a file that "
                                       "--config reads");
  add_word_option<bool>(*show, "--preset", command->seed_preset, {{"seed", true}},
                        "start from the paper's method and nothing else")
      ->option_text("seed");
  add_common_options(*show, command->common);
  show->callback([command, &status] { status = show_config(*command); });
}

}  // namespace kilter::app
