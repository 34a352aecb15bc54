// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/io/pose_list.h"
#include "kilter/submap/robot_log.h"

namespace kilter {

/// Brings clouds and a list of poses together, by file name, stamp, order or number; flat_folder.h tells when which.
///
/// Fills `log` (poses, stamps, counts, reading from files) under the name that it has.
/// \param names      of clouds in `folder`, in the order in which they would belong to the poses
/// \param pose_file  where the poses come from, for messages
/// \return  nothing; or kParse (a file named twice), kCountMismatch: which counts, or what the stamps of both sides
/// look
///          like where no cloud has a pose.
[[nodiscard]] Expected<void> pair_clouds(RobotLog& log, const std::filesystem::path& folder,
                                         const std::vector<std::string>& names, const PoseList& poses,
                                         const std::filesystem::path& pose_file, std::vector<std::string>& notes);

}  // namespace kilter
