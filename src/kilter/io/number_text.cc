// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/number_text.h"

#include <charconv>
#include <limits>
#include <system_error>

namespace kilter {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// One '+' in front, which from_chars does not take; "+-1" stays an error.
std::string_view without_plus(std::string_view word) {
  const bool plus = word.size() > 1 && word[0] == '+' && word[1] != '-' && word[1] != '+';
  return plus ? word.substr(1) : word;
}

// Whether an unsigned number that no double can hold is too large (or else too small): the decimal place of its first
// non-zero digit decides. from_chars calls both "out of range".
bool is_huge(std::string_view digits) {
  std::int64_t place = 0;
  bool leading = true;
  bool fraction = false;
  std::size_t i = 0;
  for (; i < digits.size() && (is_digit(digits[i]) || digits[i] == '.'); ++i) {
    if (digits[i] == '.') {
      fraction = true;
    } else if (leading) {
      leading = digits[i] == '0';
      if (fraction) --place;
    } else if (!fraction) {
      ++place;
    }
  }
  if (i == digits.size()) return place > 0;
  const std::string_view exponent_text = without_plus(digits.substr(i + 1));
  std::int64_t exponent = 0;
  const auto status = std::from_chars(exponent_text.data(), exponent_text.data() + exponent_text.size(), exponent).ec;
  if (status != std::errc()) return !exponent_text.starts_with('-');
  return exponent > -place;
}

}  // namespace

std::optional<double> parse_real(std::string_view word) {
  word = without_plus(word);
  double value = 0.0;
  const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (status == std::errc::invalid_argument || end != word.data() + word.size()) return std::nullopt;
  if (status == std::errc()) return value;
  const bool negative = word.starts_with('-');
  const double magnitude = is_huge(word.substr(negative ? 1 : 0)) ? std::numeric_limits<double>::infinity() : 0.0;
  return negative ? -magnitude : magnitude;
}

std::optional<std::uint64_t> parse_count(std::string_view word) {
  word = without_plus(word);
  std::uint64_t value = 0;
  const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (status != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return lower;
}

}  // namespace kilter
