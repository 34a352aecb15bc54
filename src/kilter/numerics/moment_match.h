// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "kilter/numerics/truncated_normal.h"

namespace kilter {

/// What member of the family exp(t1 x + t2 x^2) on a bounded interval has given mean and variance. Every pair with
/// 0 < variance < (mean - low)(high - mean) belongs to exactly one member; only t2 < 0 is a truncated normal.
enum class BoundedShape {
  kNormal,           ///< t2 < 0
  kExponentialLike,  ///< t2 >= 0 and monotone: falls off (or rises) no faster than an exponential
  kUniform,          ///< the density varies by less than a tenth over the interval: it fixes no parent
  kUShaped,          ///< t2 > 0 with its minimum inside: heavy at both ends
};

/// Variance of the exponential density (t2 = 0) truncated to [0, 1] with this mean; 1/12 at 1/2. It is the border
/// between kNormal (below) and the others. Precondition: 0 < mean < 1. Relative error below 1e-12.
[[nodiscard]] double truncated_exponential_variance(double mean);

/// Precondition: low < mean < high, 0 <= variance <= (mean - low)(high - mean). Variance 0 is kNormal.
[[nodiscard]] BoundedShape shape_from_moments(double mean, double variance, double low, double high);

/// The truncated normal whose *truncated* mean and variance are the given ones: the maximum-likelihood parent of a
/// sample with these moments (variance with 1/n). Damped Newton on the convex log-partition function.
///
/// \return  absent where no normal has them (shape other than kNormal, or variance 0).
/// Its mean() and variance() return the arguments to about 1e-12 of high - low and 1e-11 of variance.
[[nodiscard]] std::optional<TruncatedNormal> match_truncated_moments(double mean, double variance, double low,
                                                                     double high);

}  // namespace kilter
