// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/submap/robot_log.h"

namespace kilter {

/// Makes `log` read its cloud i from `paths[i]` by read_cloud_file, when it is asked for.
void read_from_files(RobotLog& log, std::vector<std::filesystem::path> paths);

/// Makes `log` read its finished submap i from the tree `paths[i]` by read_octree_file: as cells, and as the occupied
/// ones' centres where a cloud is asked for. The first one's header tells the size of all cells.
/// \pre  `paths` is not empty. \return what read_octree_resolution_m fails with.
[[nodiscard]] Expected<void> read_from_octrees(RobotLog& log, std::vector<std::filesystem::path> paths);

/// "000012" of "000012.pcd", as a number, if it is one.
[[nodiscard]] std::optional<std::uint64_t> number_of_file(std::string_view name);

/// The numbers by which files' names differ: 1, 10 and 2 of "scan_1.pcd", "scan_10.pcd" and "scan_2.pcd".
/// \return  one for each (of a single name number_of_file); nothing where names differ in more than one number, or a
/// name has none there
[[nodiscard]] std::optional<std::vector<std::uint64_t>> numbers_of_files(std::span<const std::string> names);

}  // namespace kilter
