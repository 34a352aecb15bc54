// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/common_options.h"

#include <algorithm>
#include <charconv>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/format.h>

#include "apps/kilter/terminal.h"
#include "apps/kilter/whole_option.h"
#include "kilter/base/parallel.h"

namespace kilter::app {

Progress::Style CommonOptions::progress_style() const {
  if (quiet) return Progress::Style::kSilent;
  if (verbose) return Progress::Style::kEvery;
  return is_terminal(stderr) ? Progress::Style::kBar : Progress::Style::kLines;
}

void add_common_options(CLI::App& command, CommonOptions& options) {
  options.jobs = std::min(available_processors(), 1024);
  std::vector<CLI::Option*> all = {
      command.add_option("--config", options.config_file, "read keys from a TOML file")->option_text("FILE.toml"),
      command.add_option("--set", options.settings, "set one key of `kilter config show`; may be repeated")
          ->option_text("KEY=VALUE")
          ->allow_extra_args(false),
      add_whole_option(command, "--jobs", options.jobs, 1, 1024, "threads to use (as many as there are processors)"),
      command
          .add_option("--memory", options.memory,
                      "most that submaps take, e.g. 4G or 512M (check: half of what is free)")
          ->option_text("SIZE"),
      command.add_flag("--quiet", options.quiet, "errors only, and the result"),
      command.add_flag("--verbose", options.verbose, "say when each stage begins and ends"),
      command.add_flag("--json", options.json, "the result as JSON on standard output, and nothing else there"),
      command.add_flag("--no-color", options.no_color, "no colours; NO_COLOR in the environment does the same")};
  for (CLI::Option* option : all) option->group("Options of all commands");
  // A script's variable that is not set, most of the time.
  const auto is_name = [](const std::string& text) {
    return text.empty() ? "expected a name, found \"\"" : std::string();
  };
  for (const char* name : {"--output", "--poses", "--cuts", "--submap-poses", "--config"}) {
    if (CLI::Option* option = command.get_option_no_throw(name)) option->check(is_name);
  }
  command.footer("");
}

Expected<Settings> read_settings(const CommonOptions& options, bool seed_preset) {
  Settings settings;
  if (seed_preset) apply_seed_preset(settings.check);
  if (!options.config_file.empty()) {
    if (auto done = apply_config_file(options.config_file, settings); !done) return pass_up(done.error());
  }
  for (const std::string& setting : options.settings) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos) {
      return fail(ErrorCode::kUsage, fmt::format("expected key=value, found \"{}\"", printable(setting)), "--set");
    }
    if (auto done = set_key(settings, setting.substr(0, equals), setting.substr(equals + 1)); !done) {
      done.error().where = "--set";
      return pass_up(done.error());
    }
  }
  if (auto fit = validate(settings.check); !fit) return pass_up(fit.error());
  if (const Expected<std::size_t> memory = parse_memory(options.memory); !memory) return pass_up(memory.error());
  return settings;
}

Expected<std::size_t> parse_memory(const std::string& text) {
  if (text.empty()) return std::size_t{0};
  double number = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), number);
  std::string unit(end, text.data() + text.size());
  if (unit.size() > 2 && unit.ends_with("iB")) unit.resize(unit.size() - 2);
  if (unit.ends_with("B")) unit.pop_back();
  constexpr std::string_view kUnits = "KMGT";
  double factor = 1.0;
  const std::size_t power = unit.size() == 1 ? kUnits.find(unit) : std::string_view::npos;
  if (power != std::string_view::npos) factor = static_cast<double>(std::uint64_t{1} << (10 * (power + 1)));
  const bool is_known = unit.empty() || power != std::string_view::npos;
  const double bytes = number * factor;
  if (status != std::errc() || !is_known || !(bytes >= 1.0 && bytes < 1e18)) {
    return fail(ErrorCode::kUsage, fmt::format("expected a size such as 512M or 4G, found \"{}\"", printable(text)),
                "--memory");
  }
  return static_cast<std::size_t>(bytes);
}

}  // namespace kilter::app
