// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kilter/io/sources/source_kind.h"

namespace kilter {

/// Whether clouds and a list of poses lie side by side in a folder, whatever else does.
[[nodiscard]] bool has_clouds_and_poses(const std::filesystem::path& folder);

/// Whether clouds lie directly in a folder beside a file that looks like a list of poses, and no folder in it is a
/// source of a kind of its own.
[[nodiscard]] bool is_flat_folder(const std::filesystem::path& folder);

/// A folder of clouds of one format and one list of poses T_world_sensor beside them (pose_list.h).
///
/// Which cloud has which pose: a table's column of file names decides if there is one. Else, if the clouds' names are
/// stamps and the poses have some, time does: the pose at the cloud's stamp, between two neighbours at most 0.25 s
/// apart, or that of one at most 5 ms away. Else as many poses as clouds belong together in order (numbers in their
/// order, other names bytewise), and if there are not as many, numbers do: a graph's ids, or stamps that are equal.
/// \return  one scan for each cloud with a pose, in order of stamps where time decided. Clouds without one are counted
/// in
///          a note. Or kEmptyInput, kNotFound (no list of poses), kUnsupported (several; clouds of two formats),
///          kCountMismatch (none or the wrong number belongs together), or what read_pose_list fails with.
[[nodiscard]] Expected<RobotLog> open_flat_folder(const SourceRequest& request, std::vector<std::string>& notes);

}  // namespace kilter
