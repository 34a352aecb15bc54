// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "kilter/registration/plane_matches.h"
#include "kilter/registration/registration.h"

namespace kilter {

/// A pose found coarsely, or another pair's, is within this of the optimum that it stands for.
inline constexpr double kWideRefinement_m = 1.0;
/// Of the search distance, for a descent that starts near its end.
inline constexpr double kCloseSearchVoxels = 6.0;
/// The kernel's scale is at least this where a descent ends.
inline constexpr double kFinalKernelVoxels = 0.5;

/// What the iterations of one search leave behind.
struct Descent {
  StopReason stop = StopReason::kTooFewMatches;
  Pose3 T;
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();  ///< of what last met, target frame
  int iterations = 0;

  [[nodiscard]] bool ended() const { return stop == StopReason::kConverged || stop == StopReason::kMaxIterations; }
};

/// Motions v0 + w x p of the target frame along which a search does not move.
using HeldMotions = std::vector<Vector6>;

/// The search distance that a descent ends with.
[[nodiscard]] double final_search_m(const PairGrain& grain, const RegistrationOptions& options);

/// Whether a place has moved by more than `range_m` from one pose to the other, or they differ by more than
/// `max_rotation_rad`.
[[nodiscard]] bool out_of_range(const Pose3& start, const Pose3& now, const Eigen::Vector3d& centre_target_m,
                                double range_m, double max_rotation_rad);

/// From the start into the nearest optimum, at most `range_m` away: Gauss-Newton on a part of the voxels, level by
/// level from options.search_distance_m down to a few voxels.
[[nodiscard]] Descent descend(PlanePair& pair, const Pose3& start, const RegistrationOptions& options, double range_m,
                              const HeldMotions& held = {});

}  // namespace kilter
