// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
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
#include "apps/kilter/output_folder.h"
#include "apps/kilter/own_files.h"
#include "apps/kilter/signals.h"
#include "apps/kilter/terminal.h"
#include "kilter/io/archive.h"
#include "kilter/io/file.h"
#include "kilter/report/json_writer.h"
#include "kilter/report/report_html.h"

namespace kilter::app {
namespace {

struct ReportCommand {
  CommonOptions common;
  std::string result;
  std::string output;
};

int refuse_output(const Error& error) {
  print_error(error);
  return exit_status_of_output(error.code);
}

Expected<void> present(const ReportCommand& command, std::size_t bytes) {
  if (command.common.json) {
    JsonWriter json;
    json.open_object().field("schema", "kilter.report/1").field("report", command.output).field("bytes", bytes);
    return print_out(json.close().take());
  }
  if (command.common.quiet) return {};
  return print_out(fmt::format("{} ({:.1f} MB); it opens in any browser, without a network\n",
                               shown(std::filesystem::path(command.output)), static_cast<double>(bytes) / 1e6));
}

int run_report(const ReportCommand& command) {
  catch_stop_signals();
  const Expected<Settings> settings = read_settings(command.common);
  if (!settings) return print_error(settings.error());
  const std::filesystem::path path = command.output;
  const std::filesystem::path result = command.result;
  const auto fit = check_output_file(path, ".html", {result, result / "result.kilter"});
  if (!fit) return print_error(fit.error());
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  if (auto fits = probe_output_folder(folder, {path.filename()}); !fits) {
    fits.error().hint = "name another file with -o";
    return refuse_output(fits.error());
  }
  if (auto ours = check_replaceable(path, kMarksOfReport); !ours) return print_error(ours.error());
  Progress progress(command.common.progress_style());
  progress.update("report", 0, 1);
  const Expected<std::string> archive = read_archive_bytes(result);
  if (!archive) return print_error(archive.error());
  const std::string html = report_html(*archive);
  if (auto done = write_output_folder(folder, {{path.filename(), html}}); !done) return refuse_output(done.error());
  progress.update("report", 1, 1);
  progress.finish();
  if (auto done = present(command, html.size()); !done) return refuse_output(done.error());
  return kExitGood;
}

}  // namespace

void add_report_command(CLI::App& program, int& status) {
  const auto command = std::make_shared<ReportCommand>();
  CLI::App* app = program.add_subcommand("report", "the report again, from a result of check");
  app->add_option("RESULT", command->result, "an output folder of `kilter check`, or its result.kilter")->required();
  app->add_option("-o,--output", command->output, "the page to write")->option_text("FILE.html REQUIRED")->required();
  add_common_options(*app, command->common);
  app->callback([command, &status] { status = run_report(*command); });
}

}  // namespace kilter::app
