// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/numerics/truncated_normal.h"

#include <algorithm>
#include <cmath>

#include "kilter/numerics/peak_view.h"

namespace kilter {
double TruncatedNormal::mean() const {
  const PeakView view = view_from_peak(*this);
  return std::clamp(view.peak + view.direction * (sigma * view.weight.moments().mean()), low, high);  // Eq. (13)
}

double TruncatedNormal::variance() const {
  const LogQuadraticMoments moments = view_from_peak(*this).weight.moments();
  const double length = sigma * moments.length;    // at most high - low: no overflow for the widest parent
  return length * length * moments.unit_variance;  // Eq. (14)
}

double TruncatedNormal::pdf(double x) const {
  if (!(x >= low && x <= high)) return 0.0;
  const PeakView view = view_from_peak(*this);
  const double v = view.direction * (x - view.peak) / sigma;
  const LogQuadraticMoments moments = view.weight.moments();
  return std::exp(view.weight.log_weight(v)) / (sigma * moments.length * moments.unit_mass);  // Eq. (12)
}

double TruncatedNormal::cdf(double x) const {
  if (!(x > low)) return 0.0;
  if (x >= high) return 1.0;
  // The law on [low, x] has a highest point of its own; the two scales differ by the weight between them.
  const PeakView view = view_from_peak(*this);
  const PeakView part = view_from_peak({mu, sigma, low, x});
  const double v = view.direction * (part.peak - view.peak) / sigma;
  const double ratio = part.weight.moments().mass() / view.weight.moments().mass();
  return std::min(1.0, std::exp(view.weight.log_weight(v)) * ratio);
}

}  // namespace kilter
