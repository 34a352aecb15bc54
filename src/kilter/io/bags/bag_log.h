// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/io/bags/bag_contents.h"
#include "kilter/submap/robot_log.h"

namespace kilter {

/// Which topics of a bag are meant, where a person says so. (PATH#/points#/odom)
using WantedTopics = std::vector<std::string>;

/// Makes one robot of a recording: clouds of one topic, each with a pose at its time.
///
/// Clouds come from the PointCloud2 topic with most messages, one in a moving frame before one in the world; poses from
/// what choose_poses takes. Poses of another frame than the clouds' are moved by static transforms where there are any.
/// Clouds that are already in the world are brought back to the sensor by their poses. Clouds without a pose are left
/// out.
/// \param where  the bag's name, for messages
/// \param notes  gains what was chosen and what was left out
/// \return  the log, which keeps the files open; or kEmptyInput (no clouds, no poses; with the topics that there are),
///          kNotFound (a wanted topic), kCountMismatch (no cloud has a pose; with both ranges of time), or what reading
///          fails with.
[[nodiscard]] Expected<RobotLog> make_bag_log(std::string name, BagFiles files, const WantedTopics& wanted,
                                              const std::string& where, std::vector<std::string>& notes);

}  // namespace kilter
