// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "kilter/base/option_table.h"
#include "kilter/consistency/distribution.h"

namespace kilter {

/// Below what the grid itself can resolve, a smaller distance or spread is no evidence of better alignment.
enum class GammaFloor {
  kQuantisation,  ///< mu_t at least 0.25 r, sigma_t at least 0.15 r: two griddings of one plane differ by that much
  kNone,          ///< Eq. (15) to the letter; rewards a parallel offset, whose distances are all equal
};

/// How a fit becomes Gamma (Sec. IV-D).
struct GammaOptions {
  GammaFloor floor = GammaFloor::kQuantisation;
};

[[nodiscard]] std::vector<OptionField> fields(GammaOptions& options);

/// One cell of Gamma or Theta with everything it was made from, so that it can be made again.
struct PairScore {
  DistributionFit fit;
  double mu_floored_m = 0.0;    ///< max(mu_t, floor)
  double var_floored_m2 = 0.0;  ///< max(var_t, floor)
  /// 1 / (mu_floored var_floored) [1/m^3]; large means consistent. Absent when infinite (floor kNone).
  std::optional<double> gamma_per_m3;
  /// Eq. (15) exactly: 1 / (mu_t var_t). Absent when infinite: a product of 0, or too small for a double.
  std::optional<double> gamma_literal_per_m3;
  std::optional<double> log10_gamma;  ///< of gamma_per_m3; absent with it
  /// G0 = Gamma r^3 / 75: about 1 for two griddings of one noise-free plane, whatever the resolution r.
  std::optional<double> gamma_dimensionless;
};

/// Scores one pair. A rigid offset can score near a good pair, so Gamma alone is never a verdict.
/// Precondition: resolution_m > 0, of the grid whose voxels were matched.
[[nodiscard]] PairScore score_pair(const DistributionFit& fit, double resolution_m, const GammaOptions& options = {});

}  // namespace kilter
