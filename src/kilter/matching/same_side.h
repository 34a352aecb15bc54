// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "kilter/geometry/pose3.h"
#include "kilter/matching/nearest_of_all.h"

namespace kilter {

/// Cosine between normals of one surface, at least: 53 degrees.
inline constexpr double kLeastAgreement = 0.6;

/// Whether surfaces of these normals, in one frame, may be the same: within 53 degrees, or one of them unknown (zero).
/// Normals point towards the sensor where there was one (`oriented`); points alone leave the sign open.
[[nodiscard]] bool normals_agree(const Eigen::Vector3d& a, const Eigen::Vector3d& b, bool oriented);

/// Of the voxels of each submap that have a surface of the other's near, how many have one near that faces the same
/// way. A floor and the ceiling under it, or the two sides of a wall, lie near each other in a right map as in a wrong
/// one: such voxels say nothing of where the two belong.
struct SameSide {
  std::size_t forward = 0;   ///< voxels of the source
  std::size_t backward = 0;  ///< voxels of the target
};

/// \param near  the nearest voxel of the other within what counts as near, between centroids; it alone is asked.
/// Points alone, without free space, leave a normal's sign open: then only surfaces across each other are told apart.
/// O(voxels of both).
[[nodiscard]] SameSide count_same_side(const VoxelMap& source, const VoxelMap& target, const Pose3& T_target_source,
                                       const NearestBothWays& near);

}  // namespace kilter
