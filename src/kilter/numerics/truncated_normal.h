// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace kilter {

/// A normal N(mu, sigma^2) conditioned on [low, high]; mu and sigma are the parent's, and mu may lie anywhere. All in
/// one unit. Precondition of every function: sigma > 0, low < high, all finite.
///
/// Eq. (12)-(14) as printed subtract cdfs and squares, which cancel: at mu = -0.7, sigma = 0.09 on [0, 1] the printed
/// variance comes out negative. Here each law is written from its highest point outwards (LogQuadratic) and its moments
/// are sums of positive terms, so they hold for mu far outside, for slivers and for intervals of a thousand sigma.
struct TruncatedNormal {
  double mu = 0.0;
  double sigma = 1.0;
  double low = 0.0;
  double high = 1.0;

  /// Eq. (13): mu + sigma (phi(alpha) - phi(beta)) / Z; in [low, high]. Error below 1e-14 of max(|mean|, high - low).
  [[nodiscard]] double mean() const;

  /// Eq. (14); in (0, (high - low)^2 / 4]. Relative error below 1e-14 where sigma's own rounding allows.
  [[nodiscard]] double variance() const;

  /// Eq. (12), with the 1/sigma that it lacks; 0 outside [low, high].
  [[nodiscard]] double pdf(double x) const;

  /// P(X <= x); relative error stays small in the lower tail.
  [[nodiscard]] double cdf(double x) const;

  bool operator==(const TruncatedNormal&) const = default;
};

}  // namespace kilter
