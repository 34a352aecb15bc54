// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "kilter/base/expected.h"

namespace kilter {

/// Unit of a numeric option; decides which suffixes are read at the edge ("10 cm", "5 deg").
enum class Unit { kNone, kMetre, kRadian, kRatio, kCount, kPerMetre };

[[nodiscard]] std::string_view unit_name(Unit unit);

/// One option as the outside sees it: the TOML reader, the command line, `--help`, the JSON echo and the manual all
/// come from these rows. `get`/`set` are bound to one live options object; `number` is null for choices.
struct OptionField {
  enum class Kind { kReal, kInteger, kBoolean, kChoice };

  std::string name;  ///< flat, snake_case; a promise
  Kind kind = Kind::kReal;
  Unit unit = Unit::kNone;
  double low = -std::numeric_limits<double>::infinity();  ///< smallest valid value, included
  double high = std::numeric_limits<double>::infinity();  ///< largest valid value, included
  std::vector<std::string> choices;                       ///< for kChoice
  std::string doc;                                        ///< one sentence
  std::string paper;                                      ///< the seed's symbol, or empty

  double* real = nullptr;
  int* integer = nullptr;
  bool* boolean = nullptr;
  std::function<std::string()> get_choice;
  std::function<void(const std::string&)> set_choice;

  /// Value as text that `assign` reads back to the same value.
  [[nodiscard]] std::string text() const;

  /// Reads "0.2", "20 cm", "5 deg", "true", "moments". \return kConfig naming key, range and value.
  [[nodiscard]] Expected<void> assign(std::string_view value) const;

  /// Takes a number in SI units. \return kConfig as above.
  [[nodiscard]] Expected<void> assign_number(double value) const;
};

/// Builders that keep a `fields()` table to one line an option.
[[nodiscard]] OptionField real_option(std::string name, double& value, Unit unit, double low, double high,
                                      std::string doc, std::string paper = {});
[[nodiscard]] OptionField count_option(std::string name, int& value, int low, int high, std::string doc,
                                       std::string paper = {});
[[nodiscard]] OptionField flag_option(std::string name, bool& value, std::string doc);

/// `names[i]` stands for the enumerator of underlying value i.
template <typename E>
[[nodiscard]] OptionField choice_option(std::string name, E& value, const std::vector<std::string>& names,
                                        std::string doc, std::string paper = {}) {
  OptionField field;
  field.name = std::move(name);
  field.kind = OptionField::Kind::kChoice;
  field.choices = names;
  field.doc = std::move(doc);
  field.paper = std::move(paper);
  field.get_choice = [&value, names] { return names.at(static_cast<std::size_t>(value)); };
  field.set_choice = [&value, names](const std::string& text) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i] == text) value = static_cast<E>(i);
    }
  };
  return field;
}

/// The key closest to `name` by edit distance, for "did you mean"; empty when nothing is near.
[[nodiscard]] std::string nearest_name(std::string_view name, const std::vector<std::string>& names);

}  // namespace kilter
