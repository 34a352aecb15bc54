// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/unused_keys.h"

#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "kilter/io/cuts.h"
#include "kilter/io/file.h"

namespace kilter::app {
namespace {

constexpr std::array<std::string_view, 5> kKeysOfScans = {"min_range", "max_range", "submap_distance",
                                                          "submap_rotation", "min_scans"};

constexpr std::array<std::string_view, 2> kKeysOfPointToPlane = {"registration_wide", "registration_points"};

constexpr std::array<std::string_view, 3> kKeysOfProbability = {"tolerance", "alpha", "prior_inconsistent"};

constexpr std::array<std::string_view, 3> kKeysOfCuts = {"submap_distance", "submap_rotation", "min_scans"};

// Those of the keys that have another value than usual.
std::vector<std::string> changed_keys(CheckOptions options, std::span<const std::string_view> keys) {
  CheckOptions usual;
  const std::vector<OptionField> usual_fields = fields(usual);
  std::vector<std::string> changed;
  for (const OptionField& option : fields(options)) {
    if (std::find(keys.begin(), keys.end(), option.name) == keys.end()) continue;
    const auto same_key = [&](const OptionField& other) { return other.name == option.name; };
    if (std::find_if(usual_fields.begin(), usual_fields.end(), same_key)->text() != option.text()) {
      changed.push_back(option.name);
    }
  }
  return changed;
}

}  // namespace

std::optional<std::string> note_on_unused_keys(const Mission& mission, const CheckOptions& options) {
  std::vector<std::string> finished;
  for (const RobotLog& robot : mission.robots) {
    if (robot.finished_submaps) finished.push_back(robot.name);
  }
  const std::vector<std::string> keys = changed_keys(options, kKeysOfScans);
  if (finished.empty() || keys.empty()) return std::nullopt;
  return fmt::format("finished submaps are taken as they are: {} {} no effect on those of {}", some_of(keys),
                     keys.size() == 1 ? "has" : "have", some_of(finished));
}

std::vector<std::string> notes_on_keys_of_other_methods(const CheckOptions& options) {
  std::vector<std::string> notes;
  const auto say = [&](std::string_view method, std::span<const std::string_view> of, std::string_view on) {
    const std::vector<std::string> keys = changed_keys(options, of);
    if (keys.empty()) return;
    notes.push_back(fmt::format("{}: {} {} no effect{}", method, some_of(keys), keys.size() == 1 ? "has" : "have", on));
  };
  if (options.registration.method == RegistrationMethod::kOicp) {
    say("pairs are aligned by the paper's OICP", kKeysOfPointToPlane, "");
  }
  if (options.judge.method == JudgeMethod::kGamma) {
    say("the paper's test holds Gamma against that of other pairs", kKeysOfProbability, " on verdicts");
  }
  return notes;
}

std::optional<std::string> take_keys_of_cuts(const std::string& cuts_result, CheckOptions& options) {
  const std::vector<std::string> set = changed_keys(options, kKeysOfCuts);
  const std::map<std::string, double> there = config_numbers_of_result(cuts_result, kKeysOfCuts);
  std::vector<std::string> without_effect;
  for (const OptionField& option : fields(options)) {
    const auto value = there.find(option.name);
    if (value == there.end()) continue;
    const std::string before = option.text();
    if (!option.assign_number(value->second) || option.text() == before) continue;
    if (std::find(set.begin(), set.end(), option.name) != set.end()) without_effect.push_back(option.name);
  }
  if (without_effect.empty()) return std::nullopt;
  return fmt::format("submaps are cut as {} has them: {} {} no effect", printable(cuts_result), some_of(without_effect),
                     without_effect.size() == 1 ? "has" : "have");
}

}  // namespace kilter::app
