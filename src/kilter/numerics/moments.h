// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

namespace kilter {

/// Count, mean and spread of numbers seen one by one or in parts. Spread is kept as the sum of squared deviations
/// from the mean (Welford, Chan), so it never cancels; equal numbers give exactly zero. Unit: that of the numbers.
struct Moments {
  std::int64_t count = 0;
  double mean = 0.0;                    ///< 0 while count is 0
  double squared_deviations_sum = 0.0;  ///< of x - mean; unit squared

  /// Takes one more number. O(1).
  void add(double x);

  /// Takes all numbers of `other`. The last bits depend on the order of merging: fold in a fixed one. O(1).
  void merge(const Moments& other);

  /// Second central moment of the numbers themselves, with 1/n, not 1/(n-1): Eq. (11) takes the moments of the
  /// histogram as a distribution, and only so is 0 <= variance <= (mean - a)(b - mean) on [a, b] certain. 0 for n < 2.
  [[nodiscard]] double variance() const;

  bool operator==(const Moments&) const = default;
};

/// Moments of all numbers in the order given. O(n).
[[nodiscard]] Moments moments_of(std::span<const double> values);

}  // namespace kilter
