// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kilter/io/sources/source_kind.h"

namespace kilter {

/// Whether a path is a bag of ROS 1: a file named .bag, or .bag.active while it was being recorded.
[[nodiscard]] bool is_rosbag1(const std::filesystem::path& path);

/// Whether a path is a bag of ROS 2: a file named .db3 (.mcap), or a folder that directly holds some, with or without
/// metadata.yaml. Those that were packed as whole files (.zstd) look like it too.
[[nodiscard]] bool is_sqlite_bag(const std::filesystem::path& path);
[[nodiscard]] bool is_mcap_bag(const std::filesystem::path& path);

/// Opens a bag as one robot; see make_bag_log. The files of a folder are the parts of one recording.
///
/// \return  besides, kUnsupported: files packed as a whole, or a folder with several files whose names do not number
/// them.
[[nodiscard]] Expected<RobotLog> open_rosbag1_source(const SourceRequest& request, std::vector<std::string>& notes);
[[nodiscard]] Expected<RobotLog> open_sqlite_source(const SourceRequest& request, std::vector<std::string>& notes);
[[nodiscard]] Expected<RobotLog> open_mcap_source(const SourceRequest& request, std::vector<std::string>& notes);

}  // namespace kilter
