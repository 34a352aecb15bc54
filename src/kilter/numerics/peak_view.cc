// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/numerics/peak_view.h"

#include "kilter/base/contract.h"

namespace kilter {

PeakView view_from_peak(const TruncatedNormal& law) {
  KILTER_EXPECTS(law.sigma > 0.0 && law.low < law.high);
  const double alpha = (law.low - law.mu) / law.sigma;
  const double beta = (law.high - law.mu) / law.sigma;
  const double width = (law.high - law.low) / law.sigma;
  if (alpha > 0.0) return {law.low, 1.0, {alpha, 1.0, 0.0, width}};
  if (beta < 0.0) return {law.high, -1.0, {-beta, 1.0, 0.0, width}};
  return {law.mu, 1.0, {0.0, 1.0, alpha, beta}};
}

}  // namespace kilter
