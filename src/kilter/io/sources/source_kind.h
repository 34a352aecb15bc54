// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/submap/robot_log.h"

namespace kilter {

/// One robot's data on disk, to be opened.
struct SourceRequest {
  std::filesystem::path path;                         ///< a folder or file that its kind recognised
  std::string name;                                   ///< what the robot is called
  std::optional<std::filesystem::path> poses_folder;  ///< holds poses.* that take the place of the source's own
  std::vector<std::string> topics;                    ///< of a bag, where a person named some: PATH#/points#/odom
  bool glance = false;                                ///< the beginning is enough where reading all takes long
};

/// A way in which one robot's (or one session's) clouds and poses lie on disk.
struct SourceKind {
  std::string_view name;  ///< as it is shown: "GLIM dump"
  /// Whether a path looks like this kind. Reads names and at most a few bytes; never fails, never follows a file's
  /// content to another place.
  bool (*matches)(const std::filesystem::path& path);
  /// Reads the poses and lists the clouds; points are read later, by RobotLog::read_cloud.
  /// \param notes  gains a line for each thing that a person should know and that is no error
  Expected<RobotLog> (*open)(const SourceRequest& request, std::vector<std::string>& notes);
  bool has_topics = false;  ///< whether it is a bag, so that PATH#/TOPIC means something
};

/// All kinds, in the order in which they are tried.
[[nodiscard]] std::span<const SourceKind> source_kinds();

/// The first kind that a path looks like; none (nullptr) for anything else, for example a folder of robots.
[[nodiscard]] const SourceKind* recognise(const std::filesystem::path& path);

}  // namespace kilter
