// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/numerics/special.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "kilter/numerics/log_quadratic.h"

namespace kilter {
namespace {

// exp(factor x^2) with the rounding error of the square put back: it alone would cost x^2 ulp.
double exp_of_square(double factor, double x) {
  const double square = x * x;
  const double lost = std::fma(x, x, -square);
  return std::exp(factor * square) * (1.0 + factor * lost);
}

}  // namespace

double erfcx(double x) {
  if (std::isnan(x)) return x;
  if (x < 0.0) {
    const double twice = 2.0 * exp_of_square(1.0, x);
    return std::isinf(twice) || std::isnan(twice) ? std::numeric_limits<double>::infinity() : twice - erfcx(-x);
  }
  if (std::isinf(x)) return 0.0;
  // erfcx(x) = 2/sqrt(pi) * integral of exp(-2 x v - v^2) over v > 0.
  const LogQuadratic weight{2.0 * x, 2.0, 0.0, std::numeric_limits<double>::infinity()};
  return 2.0 * std::numbers::inv_sqrtpi * weight.moments().mass();
}

double log_normal_tail(double z) {
  if (std::isinf(z)) return z < 0.0 ? 0.0 : -z;
  const double half_scaled = 0.5 * erfcx(std::abs(z) / std::numbers::sqrt2);
  if (z < 0.0) return std::log1p(-exp_of_square(-0.5, z) * half_scaled);
  return -0.5 * z * z + std::log(half_scaled);
}

}  // namespace kilter
