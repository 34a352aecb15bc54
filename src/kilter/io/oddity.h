// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace kilter {

/// Something about a source that is no error and seldom meant.
struct Oddity {
  std::string_view code;  ///< one of oddity_catalog(), as `kilter explain` takes it
  std::string robot;
  std::string found;  ///< with the numbers that show it
};

/// What a code means and what to do about it.
struct OddityTopic {
  std::string_view code;
  std::string_view explanation;
  std::string_view way_out;  ///< in a few words
};

[[nodiscard]] std::span<const OddityTopic> oddity_catalog();

/// What to do about an oddity, in a few words; empty for a code that is not in the catalog.
[[nodiscard]] std::string_view way_out_of(std::string_view code);

}  // namespace kilter
