// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace kilter {

/// Moments of a LogQuadratic, kept in units of the part of the interval that carries its mass, so that neither a width
/// of 1e-300 nor one of 1e300 over- or underflows before the caller scales it.
struct LogQuadraticMoments {
  double start = 0.0;          ///< lower end of the part that carries the mass
  double length = 0.0;         ///< its length
  double unit_mass = 0.0;      ///< integral of the weight, divided by length
  double unit_mean = 0.0;      ///< (mean - start) / length
  double unit_variance = 0.0;  ///< central moments 2, 3, 4 divided by length^2, ^3, ^4
  double unit_third = 0.0;
  double unit_fourth = 0.0;

  [[nodiscard]] double mass() const { return length * unit_mass; }
  [[nodiscard]] double mean() const { return start + length * unit_mean; }
  [[nodiscard]] double variance() const { return length * length * unit_variance; }
};

/// The weight exp(-slope v - curvature v^2 / 2) on [low, high], which is 1 at v = 0 and nowhere larger. Every density
/// of the truncated normal's family, in every tail and limit, becomes one of these once its highest point is moved to
/// v = 0: curvature 1 is a normal, 0 an exponential (uniform if slope is 0 too), negative one that falls more slowly.
struct LogQuadratic {
  double slope = 0.0;      ///< >= 0
  double curvature = 1.0;  ///< >= 0, or such that the weight still falls at `high`
  double low = 0.0;        ///< <= 0; 0 unless slope is 0
  double high = 1.0;       ///< > low; may be infinite when the weight falls to 0

  /// log of the weight at v.
  [[nodiscard]] double log_weight(double v) const { return -v * (slope + 0.5 * curvature * v); }

  /// Composite Gauss-Legendre over the part where the weight exceeds exp(-45). All terms are positive and the
  /// variance is summed about the mean, so nothing cancels: relative error of mass, mean - start and variance is a few
  /// 1e-16, wherever the interval lies. About 100 exponentials.
  [[nodiscard]] LogQuadraticMoments moments() const;
};

}  // namespace kilter
