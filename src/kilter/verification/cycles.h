// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "kilter/geometry/pose3.h"
#include "kilter/submap/ids.h"

namespace kilter {

/// A registration that fixes the whole pose.
struct RelativePose {
  PairId id;
  Pose3 T_target_source;
  Matrix6 covariance;  ///< of xi in T_target_source * Exp(xi), xi = (x y z rx ry rz) in the source's frame
};

/// What cycles of three registrations say of covariances.
struct CycleClosure {
  std::size_t closed = 0;             ///< cycles
  std::optional<double> nees_median;  ///< squares left over per degree of freedom; honest covariances: 0.89
  double covariance_scale = 1.0;      ///< what covariances have to be multiplied by at least
};

/// Chains the three registrations of every three submaps that are all registered with each other. The chain has to lead
/// back; what is left over has the three covariances' sum (each moved to the end of the chain) if they are honest, and
/// its square over that is chi-squared of 6 degrees of freedom. The median over the map is compared, so that a few
/// wrong registrations do not matter, and covariances are never called too wide: what a submap carries into both of its
/// registrations cancels here, though a pose graph suffers from it. Below ten cycles nothing is said.
/// `poses`: each pair once. Where a submap is registered with more than 64 later ones, 64 of those, evenly spaced, take
/// part. Cost: a small solve for each cycle, at most 4,096 a submap.
[[nodiscard]] CycleClosure close_cycles(std::span<const RelativePose> poses);

}  // namespace kilter
