// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "kilter/geometry/pose3.h"
#include "kilter/occupancy/voxel_map.h"

namespace kilter {

// PCL's registrations with their own defaults, but for what all share: correspondences up to a metre, at most 50
// iterations, and normals from the 20 nearest centroids. NDT's cells are a metre wide, its step 0.1 m.
[[nodiscard]] std::optional<Pose3> align_by_pcl_icp(const VoxelMap& source, const VoxelMap& target, const Pose3& start);
[[nodiscard]] std::optional<Pose3> align_by_pcl_plane(const VoxelMap& source, const VoxelMap& target,
                                                      const Pose3& start);
[[nodiscard]] std::optional<Pose3> align_by_pcl_gicp(const VoxelMap& source, const VoxelMap& target,
                                                     const Pose3& start);
[[nodiscard]] std::optional<Pose3> align_by_pcl_ndt(const VoxelMap& source, const VoxelMap& target, const Pose3& start);

}  // namespace kilter
