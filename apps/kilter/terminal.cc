// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/terminal.h"

#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

#include "apps/kilter/exit_status.h"

namespace kilter::app {

bool is_terminal(std::FILE* stream) {
  const char* kind = std::getenv("TERM");
  return ::isatty(::fileno(stream)) == 1 && kind != nullptr && std::string_view(kind) != "dumb";
}

bool wants_colour(bool no_color_option) {
  const char* no_color = std::getenv("NO_COLOR");
  const bool forbidden = no_color_option || (no_color != nullptr && *no_color != '\0');
  return !forbidden && is_terminal(stdout);
}

Expected<void> print_out(std::string_view text) {
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  if (written) return {};
  const int reason = errno;
  return fail(reason == ENOSPC ? ErrorCode::kNoSpace : ErrorCode::kIo,
              fmt::format("cannot be written: {}", std::generic_category().message(reason)), "standard output");
}

void print_message(std::string_view text) {
  // Nobody is left to tell when standard error is closed.
  static_cast<void>(std::fwrite(text.data(), 1, text.size(), stderr));
  static_cast<void>(std::fflush(stderr));
}

void print_note(std::string_view text) { print_message(fmt::format("note: {}\n", text)); }

int print_error(const Error& error) {
  Error whole = error;
  if (whole.hint.empty() && whole.code != ErrorCode::kCancelled) {
    whole.hint = fmt::format("kilter explain {}", error_code_name(whole.code));
  }
  print_message(to_string(whole) + '\n');
  return exit_status(error.code);
}

}  // namespace kilter::app
