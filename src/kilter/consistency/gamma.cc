// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/consistency/gamma.h"

#include <algorithm>
#include <cmath>

#include "kilter/base/contract.h"

namespace kilter {
namespace {

// Measured on planes gridded twice: distances between centroids are no smaller, nor less spread, than these parts of r.
constexpr double kMuFloorPerResolution = 0.25;
constexpr double kSigmaFloorPerResolution = 0.15;
// Gamma r^3 of such a plane, voxel centres matched.
constexpr double kPlaneGamma = 75.0;

// Eq. (15).
std::optional<double> inverse_product(double mu_m, double var_m2) {
  const double gamma = 1.0 / (mu_m * var_m2);
  return std::isfinite(gamma) ? std::optional(gamma) : std::nullopt;
}

}  // namespace

std::vector<OptionField> fields(GammaOptions& options) {
  return {choice_option("floor", options.floor, {"quantisation", "none"},
                        "Least mean and spread of distances that Gamma counts: what the grid resolves, or none (the "
                        "paper).",
                        "Eq. 15")};
}

PairScore score_pair(const DistributionFit& fit, double resolution_m, const GammaOptions& options) {
  KILTER_EXPECTS(resolution_m > 0.0);
  const double floored = options.floor == GammaFloor::kQuantisation ? 1.0 : 0.0;
  const double sigma_floor_m = floored * kSigmaFloorPerResolution * resolution_m;
  PairScore score;
  score.fit = fit;
  score.mu_floored_m = std::max(fit.mu_t_m, floored * kMuFloorPerResolution * resolution_m);
  score.var_floored_m2 = std::max(fit.var_t_m2, sigma_floor_m * sigma_floor_m);
  score.gamma_per_m3 = inverse_product(score.mu_floored_m, score.var_floored_m2);
  score.gamma_literal_per_m3 = inverse_product(fit.mu_t_m, fit.var_t_m2);
  if (score.gamma_per_m3) {
    score.log10_gamma = std::log10(*score.gamma_per_m3);
    score.gamma_dimensionless = *score.gamma_per_m3 * resolution_m * resolution_m * resolution_m / kPlaneGamma;
  }
  return score;
}

}  // namespace kilter
