// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "kilter/base/vector_path.h"
#include "kilter/geometry/pose3.h"
#include "kilter/matching/nearest_voxel.h"

namespace kilter {

/// For every voxel of one map, in their order, the voxel of another that NearestVoxelSearch::nearest finds for it, to
/// the bit; kNoVoxel where none is within `limit_m` (<= the target's max_distance_m). Positions of both searches must
/// agree. Neighbours ask together, a lane of a register for each, so that what lies around them all is looked up once.
/// O(source voxels).
[[nodiscard]] std::vector<NearestVoxel> nearest_of_all(const NearestVoxelSearch& source,
                                                       const NearestVoxelSearch& target, const Pose3& T_target_source,
                                                       double limit_m, VectorPath path = vector_paths().back());

/// The same at another pose. `found` is what was found at the last one (or kNoVoxel), from which the search sets out,
/// and what is found now; the answer does not depend on it.
void nearest_of_all_again(const NearestVoxelSearch& source, const NearestVoxelSearch& target,
                          const Pose3& T_target_source, double limit_m, std::vector<NearestVoxel>& found,
                          VectorPath path = vector_paths().back());

/// The same from each of two maps into the other.
struct NearestBothWays {
  std::vector<NearestVoxel> forward;   ///< by voxel of the source: voxels of the target
  std::vector<NearestVoxel> backward;  ///< by voxel of the target: voxels of the source
};
[[nodiscard]] NearestBothWays nearest_both_ways(const NearestVoxelSearch& source, const NearestVoxelSearch& target,
                                                const Pose3& T_target_source, double limit_m);

}  // namespace kilter
