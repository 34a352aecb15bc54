// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kilter/io/sources/source_kind.h"

namespace kilter {

/// Whether a path is a file with the name of an OctoMap tree.
[[nodiscard]] bool is_octree_file(const std::filesystem::path& path);

/// One tree as one finished submap. Its frame is the world's: the pose is the identity.
///
/// \return  a log of one submap; or what read_octree_resolution_m fails with.
[[nodiscard]] Expected<RobotLog> open_octree_file(const SourceRequest& request, std::vector<std::string>& notes);

}  // namespace kilter
