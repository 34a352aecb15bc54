// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <csignal>
#include <exception>
#include <new>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "apps/kilter/commands.h"
#include "apps/kilter/exit_status.h"
#include "apps/kilter/terminal.h"
#include "kilter/base/option_table.h"
#include "kilter/base/version.h"

namespace kilter::app {
namespace {

constexpr const char* kExamples = R"(Examples:
  kilter check mission               where does this map disagree with itself?
  kilter check mission -o result     the same, results into the folder `result`
  kilter check a=run1 b=run2         robots named one by one
  kilter info mission                what is in there?
  kilter config show                 every key, its unit, range and meaning

Exit status of check: 0 consistent, 1 inconsistent, 4 undetermined;
of all commands: 2 usage or configuration, 3 unusable input, 5 memory, disk or internal.)";

std::vector<std::string> command_names(const CLI::App& program) {
  std::vector<std::string> names;
  for (const CLI::App* command : program.get_subcommands(nullptr)) names.push_back(command->get_name());
  return names;
}

// An option that a command takes, before that command.
std::optional<Error> find_early_option(const CLI::App& program, int argc, char** argv) {
  const std::string word = argv[1];
  if (program.get_option_no_throw(word) != nullptr) return std::nullopt;
  const std::vector<std::string> names = command_names(program);
  for (int i = 2; i < argc; ++i) {
    if (std::find(names.begin(), names.end(), argv[i]) == names.end()) continue;
    return Error{
        ErrorCode::kUsage,
        fmt::format("\"{}\" stands before the command, where only --help and --version do", printable(word, 80)),
        {},
        fmt::format("kilter {} ... {}", argv[i], printable(word, 80))};
  }
  return std::nullopt;
}

// A first word that is no command: better than CLI11's own message, it knows what was meant.
std::optional<Error> find_unknown_command(const CLI::App& program, int argc, char** argv) {
  if (argc < 2) {
    return Error{ErrorCode::kUsage, "expected a command", {}, "kilter --help"};
  }
  const std::string word = argv[1];
  if (word.starts_with("-")) return find_early_option(program, argc, argv);
  const std::vector<std::string> names = command_names(program);
  if (std::find(names.begin(), names.end(), word) != names.end()) return std::nullopt;
  const std::string nearest = nearest_name(word, names);
  return Error{ErrorCode::kUsage,
               fmt::format("there is no command \"{}\"", printable(word, 80)),
               {},
               nearest.empty() ? "kilter --help" : "kilter " + nearest};
}

// The innermost command that was called, as it is typed: "kilter config show".
std::pair<const CLI::App*, std::string> called_command(const CLI::App& program) {
  const CLI::App* command = &program;
  std::string words = program.get_name();
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().front();
    words += ' ' + command->get_name();
  }
  return {command, words};
}

// Complaints that CLI11 words for who wrote the program, not for who calls it.
std::string reworded(const CLI::ParseError& error, const std::string& words, const std::vector<std::string>& unread) {
  std::string text = error.what();
  if (text == "A subcommand is required") {
    return unread.empty() ? words + " expects a command of its own"
                          : fmt::format("there is no command \"{} {}\"", words, printable(unread.front(), 80));
  }
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) == nullptr) return text;
  const std::string name = text.substr(0, text.find(':'));
  constexpr std::string_view kTooMany = ": At Most 1 required but received ";
  if (text.ends_with(" missing")) return name + ": expected a value, found none";
  if (!text.starts_with(name + std::string(kTooMany))) return text;
  return fmt::format("{}: expected once, found {} times", name, text.substr(name.size() + kTooMany.size()));
}

int refuse_command_line(const CLI::App& program, const CLI::ParseError& error) {
  const auto [command, words] = called_command(program);
  const std::vector<std::string> unread = program.remaining(true);
  if (dynamic_cast<const CLI::ExtrasError*>(&error) == nullptr || unread.empty()) {
    return print_error({ErrorCode::kUsage, printable(reworded(error, words, unread), 400), {}, words + " --help"});
  }
  std::vector<std::string> names;
  for (const CLI::Option* option : command->get_options()) names.push_back(option->get_name());
  const std::string nearest = nearest_name(unread.front(), names);
  return print_error({ErrorCode::kUsage,
                      fmt::format("{} does not take \"{}\"", words, printable(unread.front(), 80)),
                      {},
                      nearest.starts_with('-') ? nearest : words + " --help"});
}

// --help, --version
int print_wanted(const CLI::App& program, const CLI::Success& wanted) {
  std::ostringstream text;
  const int status = program.exit(wanted, text, text);
  const Expected<void> done = print_out(text.str());
  if (done) return status;
  print_error(done.error());
  return exit_status_of_output(done.error().code);
}

int run(int argc, char** argv) {
  CLI::App program("kilter finds where a 3-D lidar map built by several robots does not agree with itself.", "kilter");
  program.set_version_flag("--version", "kilter " + std::string(kVersion), "print the version");
  program.get_help_ptr()->description("print this help");
  program.footer(kExamples);
  program.require_subcommand(1);
  int status = kExitGood;
  add_check_command(program, status);
  add_info_command(program, status);
  add_register_command(program, status);
  add_report_command(program, status);
  add_simulate_command(program, status);
  add_submaps_command(program, status);
  add_config_command(program, status);
  add_explain_command(program, status);
  if (const std::optional<Error> error = find_unknown_command(program, argc, argv)) return print_error(*error);
  try {
    program.parse(argc, argv);
  } catch (const CLI::Success& wanted) {
    return print_wanted(program, wanted);
  } catch (const CLI::ParseError& error) {
    return refuse_command_line(program, error);
  }
  return status;
}

// The next file to be opened would take the place of a standard stream that the caller has closed, and get what is
// printed. What is put there can be used as little as what was closed.
void hold_closed_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(stream, F_GETFD) >= 0) continue;
    ::open("/dev/null", (stream == STDIN_FILENO ? O_WRONLY : O_RDONLY) | O_CLOEXEC);
  }
}

// Arrays of some megabytes are made and freed for every pair and submap. glibc hands their pages back each time, until
// it has seen one as large as these freed, and takes them anew. What --memory puts out goes back all the same
// (malloc_trim).
void keep_freed_pages() {
#ifdef __GLIBC__
  constexpr int kArraysFromSystem = 32 << 20;
  constexpr int kMostKept = 64 << 20;
  mallopt(M_MMAP_THRESHOLD, kArraysFromSystem);
  mallopt(M_TRIM_THRESHOLD, kMostKept);
#endif
}

}  // namespace
}  // namespace kilter::app

int main(int argc, char** argv) {
  using kilter::ErrorCode;
  kilter::app::hold_closed_streams();
  kilter::app::keep_freed_pages();
  // A file that may not grow any further and a pipe that nobody reads are errors to tell of, not reasons to die.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  try {
    return kilter::app::run(argc, argv);
  } catch (const std::bad_alloc&) {
    return kilter::app::print_error({ErrorCode::kOutOfMemory,
                                     "no more memory is to be had",
                                     {},
                                     "a coarser `resolution`, a smaller `max_range`, or fewer --jobs"});
  } catch (const std::exception& error) {
    return kilter::app::print_error({ErrorCode::kInternal, error.what(), {}, {}});
  }
}
