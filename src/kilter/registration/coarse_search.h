// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "kilter/geometry/pose3.h"
#include "kilter/occupancy/voxel_map.h"

namespace kilter {

/// How far from the start coarse_search looks.
struct CoarseSearchRange {
  /// Horizontally, in any direction, about the place that both saw, which may lie as far from the source's middle as
  /// its surfaces do: turns shift the middle by more.
  double translation_m = 1.0;
  double vertical_m = 0.5;    ///< up and down
  double rotation_rad = 0.1;  ///< about the vertical, either way
};

/// A pose worth a closer look.
struct CoarsePose {
  Pose3 T_target_source;
  double score = 0.0;  ///< weight of upright surfaces that meet upright surfaces, less what stands in free space; <= 1
};

/// Correlative scan matching on a dense grid of cells of four voxels: every shift and turn about the vertical within
/// the range is scored by the source's upright surfaces (thinned so that each facing counts alike), the best few again
/// at several heights with floors and ceilings. Tilt is left as it is: sensors know the vertical.
///
/// \param up_target  the vertical in the target's frame, unit
/// \param keep       at most this many poses are returned
/// \return best first, more than two cells or a turn of three steps apart; empty where either map holds no upright
/// surface. Deterministic. O(shifts * turns * 600) plus the target's box in cells; about 0.1 s for 5 m and 30 degrees.
[[nodiscard]] std::vector<CoarsePose> coarse_search(const VoxelMap& source, const VoxelMap& target, const Pose3& start,
                                                    const CoarseSearchRange& range, const Eigen::Vector3d& up_target,
                                                    int keep);

}  // namespace kilter
