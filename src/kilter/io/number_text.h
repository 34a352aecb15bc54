// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace kilter {

/// Blanks between the words of a line. A comma counts where the format says so.
enum class Separators { kBlanks, kBlanksAndCommas };

/// Cuts the next word off the front of `line`; empty when there is none.
template <Separators kind = Separators::kBlanks>
[[nodiscard]] inline std::string_view take_word(std::string_view& line) {
  const auto separates = [](char c) {
    return c == ' ' || c == '\t' || c == '\r' || (kind == Separators::kBlanksAndCommas && c == ',');
  };
  std::size_t first = 0;
  while (first < line.size() && separates(line[first])) ++first;
  std::size_t end = first;
  while (end < line.size() && !separates(line[end])) ++end;
  const std::string_view word = line.substr(first, end - first);
  line.remove_prefix(end);
  return word;
}

/// A decimal number, whatever the locale: "1", "+1.5", "-2e-3", "nan", "inf". The whole word must be the number.
/// What no double can hold becomes infinite or zero, as in arithmetic: "1e400" is inf, "1e-400" is 0.
[[nodiscard]] std::optional<double> parse_real(std::string_view word);

/// A whole number from 0 to 2^64 - 1, digits only (one leading '+' is read); nothing for "-1", "1.0" or "1e3".
[[nodiscard]] std::optional<std::uint64_t> parse_count(std::string_view word);

/// Letters A to Z made small, whatever the locale.
[[nodiscard]] std::string lower_case(std::string_view text);

/// a * b, or nothing when it does not fit. For sizes that a file claims.
[[nodiscard]] constexpr std::optional<std::uint64_t> checked_product(std::uint64_t a, std::uint64_t b) {
  if (b != 0 && a > UINT64_MAX / b) return std::nullopt;
  return a * b;
}

/// a + b, or nothing when it does not fit.
[[nodiscard]] constexpr std::optional<std::uint64_t> checked_sum(std::uint64_t a, std::uint64_t b) {
  if (a > UINT64_MAX - b) return std::nullopt;
  return a + b;
}

}  // namespace kilter
