// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "kilter/registration/normal_equations.h"

namespace kilter {

/// How far parts of an aligned pair still lie apart, because a submap is bent or holds a slip: no rigid motion mends
/// it.
struct Bend {
  double rms_m = 0.0;  ///< RMS over the overlap of the places' remaining displacement. [m]
  int groups = 0;      ///< independent places behind it
};

/// Residuals (all within reach, unweighted) are grouped by cell of `cell_m` and by the axis that their direction is
/// nearest to; a group's median, less its median absolute deviation, is the displacement there along that axis. Per
/// axis the mean square over groups, weighted by their residuals; the three axes add up. What moved as one counts,
/// clutter does not.
[[nodiscard]] Bend measure_bend(std::span<const PlaneResidual> residuals, double cell_m);

}  // namespace kilter
