// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/base/option_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

namespace kilter {
namespace {

struct Suffix {
  std::string_view text;
  Unit unit;
  double factor;
};

constexpr Suffix kSuffixes[] = {
    {"m", Unit::kMetre, 1.0},     {"cm", Unit::kMetre, 0.01},  {"mm", Unit::kMetre, 0.001},
    {"km", Unit::kMetre, 1000.0}, {"rad", Unit::kRadian, 1.0}, {"deg", Unit::kRadian, std::numbers::pi / 180.0},
    {"%", Unit::kRatio, 0.01},
};

std::string_view trim(std::string_view text) {
  const auto space = [](char c) { return c == ' ' || c == '\t'; };
  while (!text.empty() && space(text.front())) text.remove_prefix(1);
  while (!text.empty() && space(text.back())) text.remove_suffix(1);
  return text;
}

// "5 deg" -> 0.0873 for an angle; nullopt for text that is not a number or a unit that does not fit.
std::optional<double> read_quantity(std::string_view text, Unit unit) {
  text = trim(text);
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  double value = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc()) return std::nullopt;
  const std::string_view suffix = trim(text.substr(static_cast<std::size_t>(end - text.data())));
  if (suffix.empty()) return value;
  for (const Suffix& known : kSuffixes) {
    if (known.text == suffix && known.unit == unit) return value * known.factor;
  }
  return std::nullopt;
}

std::string range_text(const OptionField& field) {
  const std::string unit(unit_name(field.unit));
  const std::string suffix = unit.empty() ? "" : " " + unit;
  const bool open_low = std::isinf(field.low);
  const bool open_high = std::isinf(field.high);
  if (open_low && open_high) return "any number" + suffix;
  if (open_high) return fmt::format("a number >= {}{}", field.low, suffix);
  if (open_low) return fmt::format("a number <= {}{}", field.high, suffix);
  return fmt::format("a number from {} to {}{}", field.low, field.high, suffix);
}

tl::unexpected<Error> refuse(const OptionField& field, const std::string& expected, std::string_view found) {
  return fail(ErrorCode::kConfig, fmt::format("{}: expected {}, found \"{}\"", field.name, expected, printable(found)),
              {}, "kilter config show lists every key with its unit and range");
}

}  // namespace

std::string_view unit_name(Unit unit) {
  switch (unit) {
    case Unit::kMetre:
      return "m";
    case Unit::kRadian:
      return "rad";
    case Unit::kPerMetre:
      return "m/m";
    case Unit::kNone:
    case Unit::kRatio:
    case Unit::kCount:
      return "";
  }
  return "";
}

std::string OptionField::text() const {
  switch (kind) {
    case Kind::kReal:
      return fmt::format("{}", *real);
    case Kind::kInteger:
      return fmt::format("{}", *integer);
    case Kind::kBoolean:
      return *boolean ? "true" : "false";
    case Kind::kChoice:
      return get_choice();
  }
  return {};
}

Expected<void> OptionField::assign(std::string_view value) const {
  const std::string_view trimmed = trim(value);
  if (kind == Kind::kBoolean) {
    if (trimmed == "true" || trimmed == "yes" || trimmed == "1") {
      *boolean = true;
    } else if (trimmed == "false" || trimmed == "no" || trimmed == "0") {
      *boolean = false;
    } else {
      return refuse(*this, "true or false", value);
    }
    return {};
  }
  if (kind == Kind::kChoice) {
    if (std::find(choices.begin(), choices.end(), trimmed) == choices.end()) {
      return refuse(*this, fmt::format("one of {}", fmt::join(choices, ", ")), value);
    }
    set_choice(std::string(trimmed));
    return {};
  }
  const std::optional<double> number = read_quantity(trimmed, unit);
  if (!number) return refuse(*this, range_text(*this), value);
  return assign_number(*number);
}

Expected<void> OptionField::assign_number(double value) const {
  if (kind != Kind::kReal && kind != Kind::kInteger) {
    return refuse(*this, kind == Kind::kBoolean ? "true or false" : "a word", fmt::format("{}", value));
  }
  if (!(value >= low && value <= high)) return refuse(*this, range_text(*this), fmt::format("{}", value));
  if (kind == Kind::kReal) {
    *real = value;
    return {};
  }
  if (value != std::floor(value)) return refuse(*this, "a whole number", fmt::format("{}", value));
  *integer = static_cast<int>(value);
  return {};
}

OptionField real_option(std::string name, double& value, Unit unit, double low, double high, std::string doc,
                        std::string paper) {
  OptionField field;
  field.name = std::move(name);
  field.unit = unit;
  field.low = low;
  field.high = high;
  field.doc = std::move(doc);
  field.paper = std::move(paper);
  field.real = &value;
  return field;
}

OptionField count_option(std::string name, int& value, int low, int high, std::string doc, std::string paper) {
  OptionField field;
  field.name = std::move(name);
  field.kind = OptionField::Kind::kInteger;
  field.unit = Unit::kCount;
  field.low = low;
  field.high = high;
  field.doc = std::move(doc);
  field.paper = std::move(paper);
  field.integer = &value;
  return field;
}

OptionField flag_option(std::string name, bool& value, std::string doc) {
  OptionField field;
  field.name = std::move(name);
  field.kind = OptionField::Kind::kBoolean;
  field.doc = std::move(doc);
  field.boolean = &value;
  return field;
}

std::string nearest_name(std::string_view name, const std::vector<std::string>& names) {
  constexpr std::size_t kLeastBeginning = 3;
  std::string best;
  // Of a short word two letters are most of it.
  std::size_t best_distance = (name.size() <= 3 ? 1 : std::max<std::size_t>(2, name.size() / 3)) + 1;
  for (const std::string& candidate : names) {
    std::vector<std::size_t> row(candidate.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 1; i <= name.size(); ++i) {
      std::size_t diagonal = row[0];
      row[0] = i;
      for (std::size_t j = 1; j <= candidate.size(); ++j) {
        const std::size_t above = row[j];
        row[j] = std::min({row[j] + 1, row[j - 1] + 1, diagonal + (name[i - 1] == candidate[j - 1] ? 0U : 1U)});
        diagonal = above;
      }
    }
    const bool begins = name.size() >= kLeastBeginning && candidate.starts_with(name);
    const std::size_t distance = begins ? std::min<std::size_t>(row.back(), 1) : row.back();
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

}  // namespace kilter
