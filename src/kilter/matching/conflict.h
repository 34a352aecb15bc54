// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "kilter/geometry/pose3.h"
#include "kilter/matching/nearest_of_all.h"

namespace kilter {

/// Surfaces within this many voxels of each other are the same surface to the free-space test.
inline constexpr double kConflictMarginVoxels = 2.0;

/// The same in metres; a cell, where the points of a map are the centres of larger ones, tells no more than a voxel.
/// Never beyond what the searches reach.
[[nodiscard]] double conflict_margin_m(const NearestVoxelSearch& source, const NearestVoxelSearch& target);

/// One direction of free-space conflict: surfaces of one submap that stand where the other saw through.
struct ConflictCount {
  std::size_t known = 0;        ///< surface voxels in space the other knows (free with margin, or next to a surface)
  std::size_t conflicting = 0;  ///< of these, in free space with margin

  [[nodiscard]] double share() const {
    return known == 0 ? 0.0 : static_cast<double>(conflicting) / static_cast<double>(known);
  }
};

/// Both directions. A pair of points-only submaps has nothing known either way.
struct ConflictSample {
  ConflictCount source_in_target;
  ConflictCount target_in_source;

  [[nodiscard]] std::size_t known() const { return source_in_target.known + target_in_source.known; }
  [[nodiscard]] double share() const {
    return known() == 0 ? 0.0
                        : static_cast<double>(source_in_target.conflicting + target_in_source.conflicting) /
                              static_cast<double>(known());
  }
};

/// The cell and its six neighbours are free: nothing grazed it, nothing stands next to it.
[[nodiscard]] bool is_free_with_neighbours(const VoxelMap& map, const VoxelIndex& voxel);

/// Counts surface voxels (all that are occupied, by their centroids) that fall where the other submap is free: the
/// cell and its six neighbours free, and no surface near. Cells near a surface count as known but never as conflict,
/// which leaves out grazing rays and the voxels just before a hit. O(voxels).
/// \param near  what lies within the margin of each voxel, between centroids at T_target_source.
[[nodiscard]] ConflictSample measure_conflict(const VoxelMap& source, const VoxelMap& target,
                                              const Pose3& T_target_source, const NearestBothWays& near);

/// The same of every `stride`-th voxel of each; counts are of those. O(voxels / stride).
[[nodiscard]] ConflictSample sample_conflict(NearestVoxelCursor& source, NearestVoxelCursor& target,
                                             const Pose3& T_target_source, double margin_m, std::size_t stride);

}  // namespace kilter
