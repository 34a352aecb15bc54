// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <CLI/App.hpp>
#include <fmt/format.h>

#include "kilter/base/expected.h"

namespace kilter::app {

/// "a, b or c".
[[nodiscard]] std::string listed(const std::vector<std::string>& words);

/// Adds an option that takes one of a few words for a value of any type. Anything else, also the number that stands
/// behind a word, is a usage error that lists them.
template <typename T>
CLI::Option* add_word_option(CLI::App& command, const std::string& name, T& value,
                             const std::vector<std::pair<std::string, T>>& meanings, const std::string& description) {
  return command.add_option_function<std::string>(
      name,
      [name, &value, meanings](const std::string& found) {
        std::vector<std::string> words;
        for (const auto& [word, meaning] : meanings) {
          if (word == found) value = meaning;
          if (word == found) return;
          words.push_back(word);
        }
        throw CLI::ValidationError(name, fmt::format("expected {}, found \"{}\"", listed(words), printable(found, 80)));
      },
      description);
}

}  // namespace kilter::app
