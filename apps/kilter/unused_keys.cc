// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/unused_keys.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "kilter/io/file.h"

namespace kilter::app {
namespace {

constexpr std::array<std::string_view, 5> kKeysOfScans = {"min_range", "max_range", "submap_distance",
                                                          "submap_rotation", "min_scans"};

std::vector<std::string> changed_keys_of_scans(CheckOptions options) {
  CheckOptions usual;
  const std::vector<OptionField> usual_fields = fields(usual);
  std::vector<std::string> changed;
  for (const OptionField& option : fields(options)) {
    if (std::find(kKeysOfScans.begin(), kKeysOfScans.end(), option.name) == kKeysOfScans.end()) continue;
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
  const std::vector<std::string> keys = changed_keys_of_scans(options);
  if (finished.empty() || keys.empty()) return std::nullopt;
  return fmt::format("finished submaps are taken as they are: {} {} no effect on those of {}", some_of(keys),
                     keys.size() == 1 ? "has" : "have", some_of(finished));
}

}  // namespace kilter::app
