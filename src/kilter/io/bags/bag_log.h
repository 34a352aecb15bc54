// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/io/bags/bag_choice.h"
#include "kilter/io/bags/bag_contents.h"
#include "kilter/submap/robot_log.h"

namespace kilter {

/// Makes one robot of a recording: clouds of one topic, each with a pose at its time.
///
/// What is chosen: bag_choice.h. Clouds that are drawn in the world are brought back to the sensor by their poses.
/// Clouds without a pose are left out.
///
/// \param budget  what may be unpacked; clouds beyond are RobotLog::clouds_unread
/// \param where  the bag's name, for messages
/// \param notes  gains what was chosen and what was left out
/// \return  the log, which keeps the files open; or what walking the files and choosing fail with.
[[nodiscard]] Expected<RobotLog> make_bag_log(std::string name, BagFiles files, const WantedTopics& wanted,
                                              const std::string& where, std::vector<std::string>& notes,
                                              UnpackingBudget budget = {});

}  // namespace kilter
