// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kilter/io/sources/source_kind.h"

namespace kilter {

/// Whether a folder holds Scans/ beside optimized_poses.txt or singlesession_posegraph.g2o.
[[nodiscard]] bool is_lt_mapper_session(const std::filesystem::path& folder);

/// A session as LT-mapper takes it and SC-LIO-SAM, SC-A-LOAM and FAST_LIO_SLAM save it: key frames' scans, each at the
/// pose of its number in optimized_poses.txt (twelve columns). Without that file the vertices of
/// singlesession_posegraph.g2o serve, with a note: SC-LIO-SAM writes them before its last optimisation.
///
/// \return  one scan for each file of Scans/ with a pose, in order of the names; stamps from times.txt if it has as
/// many.
///          Or kEmptyInput, kCountMismatch, kUnsupported, or what the readers of poses fail with.
[[nodiscard]] Expected<RobotLog> open_lt_mapper_session(const SourceRequest& request, std::vector<std::string>& notes);

}  // namespace kilter
