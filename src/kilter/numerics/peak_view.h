// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kilter/numerics/log_quadratic.h"
#include "kilter/numerics/truncated_normal.h"

namespace kilter {

/// A truncated normal seen from its highest point: x = peak + direction * sigma * v, v weighted by `weight`. The tail
/// that carries no mass is never subtracted from anything, whichever side it is on.
struct PeakView {
  double peak = 0.0;
  double direction = 1.0;  ///< +1, or -1 when the law rises towards its upper end
  LogQuadratic weight;
};

/// Precondition: sigma > 0, low < high, all finite.
[[nodiscard]] PeakView view_from_peak(const TruncatedNormal& law);

}  // namespace kilter
