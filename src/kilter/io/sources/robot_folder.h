// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kilter/io/sources/source_kind.h"

namespace kilter {

/// Whether a folder directly holds a folder `scans` or `submaps`.
[[nodiscard]] bool is_robot_folder(const std::filesystem::path& folder);

/// One robot of a mission as kilter's own layout has it: poses.* beside scans/ or submaps/.
///
/// \return  a log with one pose per cloud, in the clouds' bytewise order of names. Or kNotFound (no poses.*),
///          kCountMismatch, kEmptyInput, kUnsupported (both scans/ and submaps/, several poses.*, mixed or unread
///          formats, a scan that is no file), or what the pose reader fails with.
[[nodiscard]] Expected<RobotLog> open_robot_folder(const SourceRequest& request, std::vector<std::string>& notes);

}  // namespace kilter
