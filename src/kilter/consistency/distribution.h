// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/base/option_table.h"
#include "kilter/numerics/moment_match.h"

namespace kilter {

/// How the truncated Gaussian of Sec. IV-C is read.
enum class DistributionFitMethod {
  kMoments,  ///< as the paper is written: sample moments are the parent's (Eq. 11), then truncated (Eq. 13-14)
  kMle,      ///< maximum likelihood: the truncated moments are the sample's, the parent is solved for
};

/// How the distances of one submap pair become a distribution (Sec. IV-B, IV-C).
struct DistributionOptions {
  double max_distance_m = 1.0;      ///< upper end of the truncation interval; the paper's d. [m], > 0
  double histogram_width_m = 0.01;  ///< bin width of the histogram that is shown; no score depends on it. [m], > 0
  DistributionFitMethod method = DistributionFitMethod::kMoments;
};

[[nodiscard]] std::vector<OptionField> fields(DistributionOptions& options);

/// Distances counted in bins [i width, (i + 1) width) of [0, d]; the last bin includes d and may be cut short by it.
struct DistanceHistogram {
  double width_m = 0.01;
  std::vector<std::int64_t> counts;
};

/// The normal before truncation. Its mean may be negative or beyond d under kMle.
struct NormalParent {
  double mu_m = 0.0;
  double sigma_m = 0.0;  ///< 0 when all distances are equal (Eq. 9, the Dirac limit)
};

/// The law of one pair's distances, and how much evidence stands behind it.
struct DistributionFit {
  /// Always there under kMoments. Under kMle only when shape is kNormal: a tail heavier than exponential, the rule
  /// rather than the exception where overlap is partial, belongs to no normal.
  std::optional<NormalParent> parent;
  double mu_t_m = 0.0;                         ///< truncated mean, Eq. (13); in [0, d]
  double var_t_m2 = 0.0;                       ///< truncated variance, Eq. (14); 0 when all distances are equal
  BoundedShape shape = BoundedShape::kNormal;  ///< of the sample's moments on [0, d], whatever the method
  std::int64_t num_matches = 0;
};

/// Models matched-voxel distances as a Gaussian truncated to [0, d]; moments come from the distances, never from bins.
///
/// \param distances_m  any order, each in [0, max_distance_m]. [m]
/// \return  the fit; kInvalidArgument for fewer than two distances, one outside [0, d] or not finite, or bad options.
/// O(n). The result depends on the order of the distances in its last bits only.
[[nodiscard]] Expected<DistributionFit> fit_distribution(std::span<const double> distances_m,
                                                         const DistributionOptions& options = {});

/// Counts the distances for display (Sec. IV-A, Fig. 3b).
///
/// \return  kInvalidArgument as above (but no distance at all is fine), and for more than a million bins.
[[nodiscard]] Expected<DistanceHistogram> histogram_distances(std::span<const double> distances_m,
                                                              const DistributionOptions& options = {});

}  // namespace kilter
