// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/io/bags/bag_contents.h"
#include "kilter/io/bags/pose_source.h"

namespace kilter {

/// Which topics of a bag are meant, where a person says so. (PATH#/points#/odom)
using WantedTopics = std::vector<std::string>;

/// Clouds of one topic, and the poses of those that have one.
struct BagChoice {
  const CloudTopic* clouds = nullptr;   ///< in the contents that were chosen from
  std::vector<std::int64_t> stamps_ns;  ///< of all clouds of the topic
  std::size_t poses_found = 0;
  std::vector<std::size_t> matched;  ///< clouds with a pose, rising
  std::vector<Pose3> T_world_cloud;  ///< of each matched cloud
  bool clouds_in_world = false;      ///< points are drawn in the poses' own frame
};

/// Chooses what a robot is made of.
///
/// Clouds come from the wanted topic, else from the PointCloud2 topic with most messages, one in a moving frame before
/// one in the world; poses from the wanted topic, else from what choose_poses takes. Poses of another frame than the
/// clouds' are moved by static transforms where there are any.
///
/// \param robot  its name, for notes
/// \param where  the bag's name, for messages
/// \param notes  gains what was chosen and what was left out
/// \return  kEmptyInput (no clouds, no poses; with the topics that there are), kNotFound (a wanted topic),
///          kCountMismatch (no cloud has a pose; with both ranges of time).
[[nodiscard]] Expected<BagChoice> choose_from(const BagContents& contents, const WantedTopics& wanted,
                                              const std::string& robot, const std::string& where,
                                              std::vector<std::string>& notes);

}  // namespace kilter
