// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <charconv>
#include <string>
#include <system_error>

#include <CLI/App.hpp>
#include <fmt/format.h>

#include "kilter/base/expected.h"

namespace kilter::app {

/// Adds an option that takes a whole number in [low, high]; anything else is a usage error that says so. CLI11 wraps
/// negative numbers around and cuts large ones.
template <typename Whole>
CLI::Option* add_whole_option(CLI::App& app, const std::string& name, Whole& value, Whole low, Whole high,
                              const std::string& about) {
  const auto read = [name, &value, low, high](const std::string& text) {
    Whole number{};
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), number);
    const bool is_whole = status == std::errc() && end == text.data() + text.size();
    if (!is_whole || number < low || number > high) {
      throw CLI::ValidationError(
          name, fmt::format("expected a whole number from {} to {}, found \"{}\"", low, high, printable(text, 80)));
    }
    value = number;
  };
  return app.add_option_function<std::string>(name, read, about)->option_text("N");
}

}  // namespace kilter::app
