// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/numerics/moments.h"

namespace kilter {

void Moments::add(double x) {
  ++count;
  const double before = x - mean;
  mean += before / static_cast<double>(count);
  squared_deviations_sum += before * (x - mean);
}

void Moments::merge(const Moments& other) {
  if (other.count == 0) return;
  if (count == 0) {
    *this = other;
    return;
  }
  const double ours = static_cast<double>(count);
  const double theirs = static_cast<double>(other.count);
  const double shift = other.mean - mean;
  count += other.count;
  const double share = theirs / static_cast<double>(count);
  mean += shift * share;
  squared_deviations_sum += other.squared_deviations_sum + shift * shift * ours * share;
}

double Moments::variance() const { return count < 2 ? 0.0 : squared_deviations_sum / static_cast<double>(count); }

Moments moments_of(std::span<const double> values) {
  Moments moments;
  for (const double x : values) moments.add(x);
  return moments;
}

}  // namespace kilter
