// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "kilter/matching/pair_grain.h"
#include "kilter/registration/normal_equations.h"

namespace kilter {

/// What the parts of an aligned pair's overlap have in common.
enum class BendKind {
  kSpace,   ///< they lie in different places: one of the two is bent
  kSource,  ///< the source saw them at different times: it slipped or drifted inside
  kTarget,  ///< the target saw them at different times
};

/// How far parts of an aligned pair still lie apart, because a submap is bent or holds a slip: no rigid motion mends
/// it.
struct Bend {
  double rms_m = 0.0;        ///< RMS over the overlap of the remaining displacement, less what noise would give. [m]
  double variance_m4 = 0.0;  ///< of its square
  BendKind kind = BendKind::kSpace;  ///< the way of cutting that shows most
  int parts = 0;                     ///< of the overlap that were looked at on their own
};

/// Cuts the overlap into parts, by place, by when the source saw it and by when the target did, and lets each part find
/// its own small motion: robust least squares on the residuals' planes with a kernel that narrows from half the reach
/// to a voxel, along the directions that the part itself fixes; nothing along the others. A motion counts where it
/// makes more of the part's residuals vanish, as far as those outnumber the ones that it brings up: clutter, which no
/// motion mends, and what only one of the two saw fit elsewhere as well, by chance. A cut shows the mean over its
/// parts, weighted by their residuals, of x^T M x (see OffsetEstimate) less what the motions' covariances alone would
/// give; the cut that shows most is told.
///
/// \param residuals  all within reach at the aligned pose, with the planarity as weight
/// \param grain      what its cells hide is no bend
/// Cost: some forty passes over the residuals; no search for neighbours.
[[nodiscard]] Bend measure_bend(std::span<const PlaneResidual> residuals, const PairGrain& grain, double reach_m);

}  // namespace kilter
