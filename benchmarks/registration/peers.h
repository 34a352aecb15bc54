// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kilter/geometry/pose3.h"
#include "kilter/occupancy/voxel_map.h"

namespace kilter {

/// Other libraries' registrations that this program was built with; may be empty.
[[nodiscard]] std::vector<std::string> peer_names();

/// One of them on the centroids of both maps, all of them, as our own registration uses. Correspondences reach a metre,
/// as ours do at first; normals are the library's own.
/// \return  T_target_source; absent where the library says that it did not converge, or knows no such method.
[[nodiscard]] std::optional<Pose3> align_by_peer(const std::string& name, const VoxelMap& source,
                                                 const VoxelMap& target, const Pose3& T_target_source_start);

}  // namespace kilter
