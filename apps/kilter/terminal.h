// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>
#include <string_view>

#include "kilter/base/expected.h"

namespace kilter::app {

/// Whether a stream ends at a terminal that understands cursor movement.
[[nodiscard]] bool is_terminal(std::FILE* stream);

/// Whether to colour standard output: a terminal, no --no-color, no NO_COLOR in the environment.
[[nodiscard]] bool wants_colour(bool no_color_option);

/// Writes all of `text` to standard output. \return kNoSpace or kIo when it does not take it.
[[nodiscard]] Expected<void> print_out(std::string_view text);

/// Writes to standard error; what it does not take is lost.
void print_message(std::string_view text);

/// A line for the person, on standard error: "note: ...".
void print_note(std::string_view text);

/// The one form of error messages, on standard error: to_string(error), where an error knows nothing better with
/// `kilter explain CODE` as what to try. \return the exit status that goes with it.
int print_error(const Error& error);

}  // namespace kilter::app
