// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/consistency/distribution.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "kilter/base/parallel.h"
#include "kilter/numerics/moments.h"
#include "kilter/numerics/truncated_normal.h"

namespace kilter {
namespace {

constexpr double kMaxBins = 1e6;

bool is_positive_length(double x) { return std::isfinite(x) && x > 0.0; }

Expected<void> check_distances(std::span<const double> distances_m, double max_distance_m) {
  if (!is_positive_length(max_distance_m)) {
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("DistributionOptions.max_distance_m = {} m; must be finite and > 0 m (paper: d)", max_distance_m));
  }
  for (std::size_t i = 0; i < distances_m.size(); ++i) {
    if (distances_m[i] >= 0.0 && distances_m[i] <= max_distance_m) continue;
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("distance {} is {} m; expected 0 to {} m", i, distances_m[i], max_distance_m), {},
                "match voxels with the same maximum distance that the distribution is fitted on");
  }
  return {};
}

// Reading A. Eq. (11), sign corrected: parent mean and variance are the sample's; then Eq. (13)-(14) on [0, d].
void fit_by_moments(const Moments& sample, double max_distance_m, DistributionFit& fit) {
  const TruncatedNormal law{sample.mean, std::sqrt(sample.variance()), 0.0, max_distance_m};
  fit.parent = NormalParent{law.mu, law.sigma};
  fit.mu_t_m = law.mean();
  fit.var_t_m2 = law.variance();
}

// Reading B. exp(t1 x + t2 x^2) is a regular exponential family: at the maximum its moments are the sample's.
void fit_by_likelihood(const Moments& sample, double max_distance_m, DistributionFit& fit) {
  fit.mu_t_m = sample.mean;
  fit.var_t_m2 = sample.variance();
  if (fit.shape != BoundedShape::kNormal) return;
  const auto law = match_truncated_moments(sample.mean, sample.variance(), 0.0, max_distance_m);
  if (law) fit.parent = NormalParent{law->mu, law->sigma};
}

}  // namespace

std::vector<OptionField> fields(DistributionOptions& options) {
  return {
      real_option("d", options.max_distance_m, Unit::kMetre, 0.01, 100.0,
                  "Largest distance at which two voxels are matched; upper end of the truncated Gaussian.", "d"),
      real_option("histogram_width", options.histogram_width_m, Unit::kMetre, 1e-4, 10.0,
                  "Bin width of the distance histograms that are written and drawn; no score depends on it."),
      choice_option("fit", options.method, {"moments", "mle"},
                    "How the truncated Gaussian is fitted: sample moments, then truncation (the paper), or maximum "
                    "likelihood.",
                    "Eq. 11-14"),
  };
}

Expected<DistributionFit> fit_distribution(std::span<const double> distances_m, const DistributionOptions& options) {
  if (auto checked = check_distances(distances_m, options.max_distance_m); !checked) return pass_up(checked.error());
  if (distances_m.size() < 2) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("a distribution needs at least 2 matched distances, got {}", distances_m.size()));
  }
  const double d = options.max_distance_m;
  const Moments sample = reduce_blocks(distances_m, Moments{}, RunContext{}, moments_of);
  DistributionFit fit;
  fit.num_matches = sample.count;
  // All equal, or equal up to rounding at an end of [0, d]: Eq. (9), the Dirac limit of the normal.
  if (sample.variance() <= 0.0 || sample.mean <= 0.0 || sample.mean >= d) {
    fit.parent = NormalParent{sample.mean, 0.0};
    fit.mu_t_m = sample.mean;
    return fit;
  }
  fit.shape = shape_from_moments(sample.mean, sample.variance(), 0.0, d);
  if (options.method == DistributionFitMethod::kMoments) {
    fit_by_moments(sample, d, fit);
  } else {
    fit_by_likelihood(sample, d, fit);
  }
  return fit;
}

Expected<DistanceHistogram> histogram_distances(std::span<const double> distances_m,
                                                const DistributionOptions& options) {
  if (auto checked = check_distances(distances_m, options.max_distance_m); !checked) return pass_up(checked.error());
  const double width = options.histogram_width_m;
  // d / width may land a rounding above a whole number, which is not another bin.
  const double bins = std::ceil(options.max_distance_m / width * (1.0 - 1e-12));
  if (!is_positive_length(width) || bins > kMaxBins) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("DistributionOptions.histogram_width_m = {} m on [0, {}] m; must be > 0 m and make at most "
                            "{} bins",
                            width, options.max_distance_m, kMaxBins));
  }
  DistanceHistogram histogram{width, std::vector<std::int64_t>(static_cast<std::size_t>(bins), 0)};
  const std::size_t last = histogram.counts.size() - 1;
  for (const double x : distances_m) ++histogram.counts[std::min(last, static_cast<std::size_t>(x / width))];
  return histogram;
}

}  // namespace kilter
