// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "kilter/verification/judge.h"

namespace kilter {
namespace {

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct Typical {
  double median = 0.0;
  double spread = 0.0;
};

Typical typical_of(const std::vector<double>& values) {
  if (values.empty()) return {};
  Typical typical{median_of(values), 0.0};
  std::vector<double> deviations;
  deviations.reserve(values.size());
  for (const double value : values) deviations.push_back(std::abs(value - typical.median));
  typical.spread = 1.4826 * median_of(deviations);
  return typical;
}

// Fewer pairs than this would be compared with little but themselves: their conflict is typical only as far as it is
// that of other maps. (0 to 3 % over 200 simulated and real ones, `benchmarks/accuracy/run`, `benchmarks/real`.)
constexpr std::size_t kFewestOfNull = 8;
constexpr double kMostOfFew = 0.03;
constexpr double kMostSpreadOfFew = 0.01;

// Lower quartile, and the spread that a normal law has between it and its lower twentieth: holds up where most pairs
// are bad, as where one wrong closure bent the whole map.
Typical lower_quarter_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const double quarter = values[values.size() / 4];
  return {quarter, (quarter - values[values.size() / 20]) / (1.6449 - 0.6745)};
}

}  // namespace

MapNull estimate_null(std::span<const PairEvidence* const> pairs) {
  const auto registered_sequential = std::count_if(pairs.begin(), pairs.end(), [](const PairEvidence* pair) {
    return pair->registered && pair->kind == PairKind::kSequential;
  });
  std::vector<double> gammas;
  std::vector<double> thetas;
  std::vector<double> conflicts;
  MapNull null;
  for (const PairEvidence* pair : pairs) {
    if (!pair->registered || (registered_sequential >= 2 && pair->kind != PairKind::kSequential)) continue;
    if (pair->map.score && pair->map.score->log10_gamma) gammas.push_back(*pair->map.score->log10_gamma);
    const std::optional<PairScore>& theta = pair->registered->score;
    if (theta && theta->log10_gamma) thetas.push_back(*theta->log10_gamma);
  }
  for (const PairEvidence* pair : pairs) {
    if (pair->registered && pair->registered->conflict.known() > 0) {
      conflicts.push_back(pair->registered->conflict.share());
    }
  }
  null.pairs = gammas.size();
  null.pairs_with_free = conflicts.size();
  const Typical gamma = typical_of(gammas);
  null.log10_gamma = gamma.median;
  null.log10_gamma_spread = gamma.spread;
  const Typical theta = typical_of(thetas);
  null.log10_theta = theta.median;
  null.log10_theta_spread = theta.spread;
  const bool few = conflicts.size() < kFewestOfNull;
  Typical conflict = lower_quarter_of(std::move(conflicts));
  if (few) conflict = {std::min(conflict.median, kMostOfFew), std::min(conflict.spread, kMostSpreadOfFew)};
  null.conflict = conflict.median;
  null.conflict_spread = conflict.spread;
  return null;
}

}  // namespace kilter
