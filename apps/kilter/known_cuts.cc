// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/known_cuts.h"

#include <vector>

#include <fmt/format.h>

#include "kilter/io/file.h"

namespace kilter::app {

Expected<Cuts> read_cuts_for(Mission& mission, const std::string& result) {
  Expected<Cuts> cuts = read_cuts(result);
  if (!cuts) return cuts;
  std::vector<std::string> known;
  for (const auto& [robot, ranges] : *cuts) known.push_back(robot);
  std::vector<std::string> unknown;
  for (const RobotLog& robot : mission.robots) {
    if (!cuts->contains(robot.name)) unknown.push_back(robot.name);
  }
  if (unknown.size() == mission.robots.size()) {
    return fail(
        ErrorCode::kCountMismatch,
        fmt::format("cuts for {}, and none for the robots that there are: {}", some_of(known), some_of(unknown)),
        printable(result), "call robots as they were called there: NAME=PATH");
  }
  if (!unknown.empty()) {
    mission.notes.push_back(fmt::format("{} has no cuts for {}, cut anew", printable(result), some_of(unknown)));
  }
  return cuts;
}

}  // namespace kilter::app
