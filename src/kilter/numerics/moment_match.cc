// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/numerics/moment_match.h"

#include <algorithm>
#include <cmath>

#include "kilter/base/contract.h"
#include "kilter/numerics/log_quadratic.h"
#include "kilter/numerics/peak_view.h"

namespace kilter {
namespace {

constexpr double kFlatLogRange = 0.1;   // log density ranges less than this: uniform
constexpr double kBorderMargin = 1e-9;  // relative; nearer to the exponential, a parent has no digits left
constexpr double kMaxBoundaryStep = 0.9;

// Variance on [0, 1] of exp(-k v + bend k v^2 / 2), its k chosen for the mean given (at most 1/2): bend 0 is the
// exponential, bend 1 the slowest monotone fall (slope 0 at v = 1).
double monotone_variance(double mean, double bend) {
  // The mean falls with k from 1/2; Newton, kept inside a bracket that it narrows.
  double low = 0.0;
  double high = 2.0 / mean;
  double k = mean < 0.2 ? 1.0 / mean : (bend > 0.0 ? 24.0 : 12.0) * (0.5 - mean);
  LogQuadraticMoments at;
  for (int iteration = 0; iteration < 100; ++iteration) {
    at = LogQuadratic{k, -bend * k, 0.0, 1.0}.moments();
    const double excess = at.mean() - mean;
    (excess > 0.0 ? low : high) = k;
    const double length = at.length;
    const double covariance = length * length * (length * at.unit_third + 2.0 * at.mean() * at.unit_variance);
    const double rate = at.variance() - 0.5 * bend * covariance;
    double next = k + excess / rate;
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    if (std::abs(next - k) <= 1e-14 * k) break;
    k = next;
  }
  return at.variance();
}

// One Newton step from the uniform gives (t1, t2) to first order: enough to tell a density that is nearly flat.
bool is_flat(double mean, double variance) {
  const double g1 = mean - 0.5;
  const double g2 = variance + mean * mean - 1.0 / 3.0;
  const double t1 = 192.0 * g1 - 180.0 * g2;  // inverse of the covariance of (x, x^2) under the uniform
  const double t2 = 180.0 * (g2 - g1);
  const double turn = t2 == 0.0 ? 0.0 : std::clamp(-0.5 * t1 / t2, 0.0, 1.0);
  const auto [least, most] = std::minmax({0.0, t1 + t2, turn * (t1 + turn * t2)});
  return most - least < kFlatLogRange;
}

// exp(a z + b z^2) on [low, high], b < 0, in units of the sample: z = (x - mean) / sd. Sought: E z = 0 and E z^2 = 1.
struct NaturalNormal {
  double a;
  double b;
  double low;
  double high;

  [[nodiscard]] TruncatedNormal law() const {
    const double sigma2 = -0.5 / b;
    return {a * sigma2, std::sqrt(sigma2), low, high};
  }
};

struct Residual {
  double objective;      // log-partition minus b; convex, smallest at the solution
  double g1;             // E z
  double g2;             // E z^2 - 1
  double h11, h12, h22;  // covariance of (z, z^2): the Hessian
};

Residual residual_at(const NaturalNormal& natural) {
  const TruncatedNormal law = natural.law();
  const PeakView view = view_from_peak(law);
  const LogQuadraticMoments at = view.weight.moments();
  const double length = law.sigma * at.length;
  const double length2 = length * length;
  const double mean = view.peak + view.direction * (law.sigma * at.mean());
  const double variance = length2 * at.unit_variance;
  const double third = view.direction * length2 * length * at.unit_third;
  const double fourth = length2 * length2 * at.unit_fourth;
  Residual r{};
  r.objective = view.peak * (natural.a + natural.b * view.peak) + std::log(length * at.unit_mass) - natural.b;
  r.g1 = mean;
  r.g2 = variance + mean * mean - 1.0;
  r.h11 = variance;
  r.h12 = third + 2.0 * mean * variance;
  r.h22 = fourth + 4.0 * mean * (third + mean * variance) - variance * variance;
  return r;
}

struct Step {
  double a;
  double b;
  double decrease;  // of the objective, promised by the slope for a whole step; > 0
};

Step newton_step(const Residual& r) {
  const double determinant = r.h11 * r.h22 - r.h12 * r.h12;
  const double a = -(r.h22 * r.g1 - r.h12 * r.g2) / determinant;
  const double b = -(r.h11 * r.g2 - r.h12 * r.g1) / determinant;
  return {a, b, -(a * r.g1 + b * r.g2)};
}

// The objective is convex in (a, b), so damped Newton gets there from anywhere with b < 0.
NaturalNormal solve_from(NaturalNormal natural) {
  Residual r = residual_at(natural);
  for (int iteration = 0; iteration < 200; ++iteration) {
    const Step step = newton_step(r);
    if (!(step.decrease > 1e-30)) break;
    double part = step.b > 0.0 ? std::min(1.0, -kMaxBoundaryStep * natural.b / step.b) : 1.0;
    NaturalNormal next = natural;
    Residual next_r = r;
    for (int halving = 0; halving < 60; ++halving, part *= 0.5) {
      next.a = natural.a + part * step.a;
      next.b = natural.b + part * step.b;
      next_r = residual_at(next);
      // Near the solution the objective has no digits left to judge by; there Newton needs no judge.
      if (step.decrease < 1e-9 || next_r.objective <= r.objective - 1e-4 * part * step.decrease) break;
    }
    natural = next;
    r = next_r;
  }
  return natural;
}

}  // namespace

double truncated_exponential_variance(double mean) {
  KILTER_EXPECTS(mean > 0.0 && mean < 1.0);
  return monotone_variance(std::min(mean, 1.0 - mean), 0.0);
}

BoundedShape shape_from_moments(double mean, double variance, double low, double high) {
  KILTER_EXPECTS(low < mean && mean < high && variance >= 0.0);
  const double width = high - low;
  const double unit_mean = std::min(mean - low, high - mean) / width;
  const double unit_variance = variance / (width * width);
  if (is_flat(unit_mean, unit_variance)) return BoundedShape::kUniform;
  if (unit_variance < (1.0 - kBorderMargin) * monotone_variance(unit_mean, 0.0)) return BoundedShape::kNormal;
  if (unit_variance <= monotone_variance(unit_mean, 1.0)) return BoundedShape::kExponentialLike;
  return BoundedShape::kUShaped;
}

std::optional<TruncatedNormal> match_truncated_moments(double mean, double variance, double low, double high) {
  if (variance <= 0.0 || shape_from_moments(mean, variance, low, high) != BoundedShape::kNormal) return std::nullopt;
  const double sd = std::sqrt(variance);
  const NaturalNormal start{0.0, -0.5, (low - mean) / sd, (high - mean) / sd};
  const TruncatedNormal law = solve_from(start).law();
  return TruncatedNormal{mean + sd * law.mu, sd * law.sigma, low, high};
}

}  // namespace kilter
