// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "kilter/base/option_table.h"
#include "kilter/geometry/pose3.h"
#include "kilter/matching/nearest_voxel.h"

namespace kilter {

/// How voxels of a pair are matched and how far apart they count (Sec. IV-A, Eq. 8).
struct MatchingOptions {
  double max_distance_m = 1.0;      ///< the paper's d: farther voxels do not match. [m]
  double occupancy_weight_m = 0.1;  ///< metres that a difference of 1 in occupancy probability counts as. [m]
  VoxelPosition position = VoxelPosition::kCentre;
  double overlap_min = 0.15;  ///< matched fraction below which a pair says nothing
  int matched_min = 200;      ///< matched voxels below which a pair says nothing
};

[[nodiscard]] std::vector<OptionField> fields(MatchingOptions& options);

/// OICP distances of one directed pair, in the order of the source's voxels.
struct DistanceSample {
  std::vector<double> distances_m;  ///< d_e + d_f of each matched voxel, in [0, max_distance_m]
  std::size_t candidates = 0;       ///< source voxels inside the target's box widened by max_distance_m
  double mean_euclidean_m = 0.0;    ///< mean of d_e over the matched
  double mean_occupancy_m = 0.0;    ///< mean of d_f over the matched

  [[nodiscard]] std::size_t matched() const { return distances_m.size(); }
  /// Matched fraction of the candidates; 0 without candidates.
  [[nodiscard]] double overlap() const {
    return candidates == 0 ? 0.0 : static_cast<double>(matched()) / static_cast<double>(candidates);
  }
};

/// Eq. (8): d(m_i, n_j) = d_e + d_f with n_j the voxel of the target closest to m_i, and d_f = occupancy_weight *
/// |p_i - p_j|. A source voxel matches if its d is at most max_distance_m. Both searches' positions must agree.
/// O(source voxels), exact.
[[nodiscard]] DistanceSample measure_distances(const NearestVoxelSearch& source, const NearestVoxelSearch& target,
                                               const Pose3& T_target_source, const MatchingOptions& options);

/// What measure_distances would find, guessed from some of the source's voxels.
struct OverlapEstimate {
  double matched = 0.0;
  double overlap = 0.0;
  double matched_at_most = 0.0;  ///< more in about one of a thousand guesses
  double overlap_at_most = 0.0;  ///< the same
};

/// Looks at up to `max_samples` voxels of the source, spread over those whose blocks reach into the target's box
/// widened by max_distance_m; where these are no more, nothing is guessed. O(blocks of the source + max_samples).
[[nodiscard]] OverlapEstimate estimate_overlap(const VoxelMap& source, NearestVoxelCursor& target,
                                               const Pose3& T_target_source, const MatchingOptions& options,
                                               std::size_t max_samples);

}  // namespace kilter
