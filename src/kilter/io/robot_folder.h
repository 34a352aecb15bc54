// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/submap/robot_log.h"

namespace kilter {

/// One robot's place on disk.
struct RobotFolder {
  std::string name;
  std::filesystem::path folder;        ///< holds scans/ or submaps/
  std::filesystem::path poses_folder;  ///< holds poses.*; most often the same
};

/// Whether a folder directly holds a folder `scans` or `submaps`.
[[nodiscard]] bool is_robot_folder(const std::filesystem::path& folder);

/// Reads the poses and lists the clouds; points are read later, cloud by cloud, by RobotLog::read_cloud.
///
/// \param notes  gains a line for each thing that a person should know and that is no error
/// \return  a log with one pose per cloud, in the clouds' bytewise order of names. Or kNotFound (no poses.*),
///          kCountMismatch, kEmptyInput, kUnsupported (both scans/ and submaps/, several poses.*, mixed or unread
///          formats, a scan that is no file), or what the pose reader fails with.
[[nodiscard]] Expected<RobotLog> open_robot(const RobotFolder& robot, std::vector<std::string>& notes);

}  // namespace kilter
