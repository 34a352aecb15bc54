// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "kilter/geometry/pose3.h"
#include "kilter/occupancy/voxel_map.h"

namespace kilter {

// Open3D's registrations: correspondences up to a metre, at most 50 iterations, normals and covariances from the 20
// nearest centroids.
[[nodiscard]] std::optional<Pose3> align_by_open3d_plane(const VoxelMap& source, const VoxelMap& target,
                                                         const Pose3& start);
[[nodiscard]] std::optional<Pose3> align_by_open3d_gicp(const VoxelMap& source, const VoxelMap& target,
                                                        const Pose3& start);

}  // namespace kilter
