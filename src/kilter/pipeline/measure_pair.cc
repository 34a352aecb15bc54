// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/pipeline/measure_pair.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "kilter/matching/same_side.h"
#include "kilter/registration/point_to_plane.h"
#include "kilter/registration/uncertainty.h"

namespace kilter {
namespace {

// The prior on rotation where the scene leaves one open: what a front end may have turned by over a submap.
constexpr double kPriorRotation_rad = 0.03;
// A prior on translation never below this, however short the path between two submaps was. [m]
constexpr double kLeastPrior_m = 0.05;
// Source voxels looked at to see whether a candidate is worth measuring.
constexpr std::size_t kGlanceVoxels = 500;
// Signs that registration ended in the wrong basin.
constexpr double kDoubtfulConflict = 0.03;
constexpr double kFarMove_m = 0.3;

// Both submaps' searches, by the points of the paper's distances and by centroids, and what the look at one pose found
// out for the next.
struct PairSearches {
  explicit PairSearches(const PlacedPair& maps)
      : source(maps.source.searchable.by_position()),
        target(maps.target.searchable.by_position()),
        source_centroids(maps.source.searchable.by_centroid()),
        target_centroids(maps.target.searchable.by_centroid()) {}

  NearestVoxelCursor source;
  NearestVoxelCursor target;
  NearestVoxelCursor source_centroids;
  NearestVoxelCursor target_centroids;
};

// The paper's numbers are directed (source into target); whether there is enough to say anything must not depend on
// which of the two robots comes first, so the gate looks both ways.
struct TwoWaySample {
  DistanceSample forward;
  DistanceSample backward;
  double voxels_per_cell = 1.0;  // that are one measurement

  [[nodiscard]] std::size_t matched() const { return std::min(forward.matched(), backward.matched()); }
  [[nodiscard]] double overlap() const { return std::max(forward.overlap(), backward.overlap()); }
  [[nodiscard]] bool enough_matched(const MatchingOptions& options) const {
    return static_cast<double>(matched()) >= options.matched_min * voxels_per_cell;
  }
  [[nodiscard]] bool passes_gate(const MatchingOptions& options) const {
    return enough_matched(options) && overlap() >= options.overlap_min;
  }
};

TwoWaySample sample_both_ways(const PairSearches& pair, const Pose3& T_target_source, const CheckOptions& options) {
  const NearestVoxelSearch& source = pair.source.search();
  const NearestVoxelSearch& target = pair.target.search();
  return {measure_distances(source, target, T_target_source, options.matching),
          measure_distances(target, source, T_target_source.inverse(), options.matching),
          grain_of(source.map(), target.map()).voxels_per_cell};
}

// Absent when nothing matched.
std::optional<DistanceHistogram> histogram_of(const TwoWaySample& sample, const CheckOptions& options) {
  if (sample.forward.matched() == 0) return std::nullopt;
  auto histogram = histogram_distances(sample.forward.distances_m, options.distribution);
  return histogram ? std::optional(std::move(*histogram)) : std::nullopt;
}

// Surfaces within the margin of the free-space test.
NearestBothWays near_surfaces(const PairSearches& pair, const Pose3& T_target_source) {
  return nearest_both_ways(pair.source_centroids.search(), pair.target_centroids.search(), T_target_source,
                           conflict_margin_m(pair.source_centroids.search(), pair.target_centroids.search()));
}

PoseEvidence measure_at(const PairSearches& pair, const Pose3& T_target_source, const TwoWaySample& sample,
                        const NearestBothWays& near, const CheckOptions& options) {
  const double resolution_m = pair.target.map().resolution_m();
  PoseEvidence evidence;
  evidence.matched = sample.matched();
  evidence.overlap = sample.overlap();
  evidence.histogram = histogram_of(sample, options);
  evidence.mean_distance_m = 0.5 * (sample.forward.mean_euclidean_m + sample.backward.mean_euclidean_m);
  if (sample.passes_gate(options.matching)) {
    const Expected<DistributionFit> fit = fit_distribution(sample.forward.distances_m, options.distribution);
    if (fit) evidence.score = score_pair(*fit, resolution_m, options.gamma);
  }
  evidence.conflict = measure_conflict(pair.source.map(), pair.target.map(), T_target_source, near);
  return evidence;
}

// Measuring every voxel of every pair whose boxes touch would cost more than all the rest: a look at some of them
// tells those that cannot pass the gate.
bool could_pass_gate(PairSearches& pair, const Pose3& T_target_source, const MatchingOptions& options) {
  const OverlapEstimate forward =
      estimate_overlap(pair.source.map(), pair.target, T_target_source, options, kGlanceVoxels);
  const OverlapEstimate backward =
      estimate_overlap(pair.target.map(), pair.source, T_target_source.inverse(), options, kGlanceVoxels);
  return std::min(forward.matched_at_most, backward.matched_at_most) >= options.matched_min &&
         std::max(forward.overlap_at_most, backward.overlap_at_most) >= options.overlap_min;
}

// The gates once more, for voxels that face the same way and are no farther apart than one surface may be.
std::optional<CommonSurface> common_surface(const PairSearches& pair, const Pose3& T_target_source,
                                            const TwoWaySample& sample, const NearestBothWays& near,
                                            const MatchingOptions& options) {
  if (!pair.source.map().has_free_space() || !pair.target.map().has_free_space()) return std::nullopt;
  const SameSide same = count_same_side(pair.source.map(), pair.target.map(), T_target_source, near);
  const auto share = [](std::size_t count, std::size_t of) {
    return of == 0 ? 0.0 : static_cast<double>(count) / static_cast<double>(of);
  };
  CommonSurface common;
  common.matched = std::min(same.forward, same.backward);
  common.overlap =
      std::max(share(same.forward, sample.forward.candidates), share(same.backward, sample.backward.candidates));
  common.any = static_cast<double>(common.matched) >= options.matched_min * sample.voxels_per_cell;
  common.enough = common.any && common.overlap >= options.overlap_min;
  return common;
}

std::string gate_reason(const TwoWaySample& sample, const CandidatePair& pair, const MatchingOptions& options) {
  std::string reason = !sample.enough_matched(options)
                           ? fmt::format("too little overlap: {} voxels of one match, {:.0f} are needed",
                                         sample.matched(), options.matched_min * sample.voxels_per_cell)
                           : fmt::format("too little overlap: {:.0f} % of the voxels match, {:.0f} % are needed",
                                         100.0 * sample.overlap(), 100.0 * options.overlap_min);
  const double shift_m = pair.predicted_shift_m.norm();
  if (shift_m > 0.0 && pair.predicted_enough) {
    reason += fmt::format("; moved by {:.1f} m, within what odometry may have drifted, it would overlap {:.0f} %",
                          shift_m, 100.0 * pair.predicted_overlap);
  }
  return reason;
}

// Measures the pair again where registration put it.
void measure_registered(PairSearches& pair, const CheckOptions& options, PairEvidence& evidence) {
  evidence.registered.reset();
  if (!evidence.registration->converged()) return;
  const Pose3& T_registered = evidence.registration->T_target_source_closest;
  evidence.registered = measure_at(pair, T_registered, sample_both_ways(pair, T_registered, options),
                                   near_surfaces(pair, T_registered), options);
}

// Whether the local search may have ended in the wrong place: it did not converge, lost what it began with, left
// surfaces in free space, or moved so far that another optimum could have been as near.
bool basin_is_doubtful(const PairEvidence& evidence) {
  if (!evidence.registered) return true;
  const PoseEvidence& after = *evidence.registered;
  if (after.overlap < kOverlapKept * evidence.map.overlap) return true;
  if (after.conflict.share() > kDoubtfulConflict) return true;
  const Pose3 moved = evidence.registration->T_target_source_closest * evidence.T_target_source.inverse();
  const Eigen::Vector3d& centre_m = evidence.registration->centre_target_m;
  return (moved.inverse() * centre_m - centre_m).norm() > kFarMove_m;
}

// What is known of the relative position before looking. Inside one robot odometry bounds it; how the frames of two
// robots lie to each other nothing bounds, so at least the search distance is open.
double prior_translation_m(const CandidatePair& pair, const CheckOptions& options) {
  const double least_m = pair.kind == PairKind::kGlobal ? options.matching.max_distance_m : kLeastPrior_m;
  return std::max(pair.drift_allowance_m, least_m);
}

RegistrationPrior prior_of(const CandidatePair& pair, const PlacedMap& target, const CheckOptions& options) {
  return {prior_translation_m(pair, options), kPriorRotation_rad,
          target.T_world_submap.rotation().conjugate() * Eigen::Vector3d::UnitZ()};
}

}  // namespace

CheckOptions resolved(CheckOptions options) {
  options.distribution.max_distance_m = options.matching.max_distance_m;
  options.pairing.max_distance_m = options.matching.max_distance_m;
  options.pairing.overlap_min = options.matching.overlap_min;
  options.pairing.matched_min = options.matching.matched_min;
  options.registration.search_distance_m = options.matching.max_distance_m;
  options.registration.min_matches = std::min(options.registration.min_matches, options.matching.matched_min);
  return options;
}

SearchSetup search_setup(const CheckOptions& options) {
  return {options.matching.position,
          std::max(options.matching.max_distance_m, kConflictMarginVoxels * options.submap.occupancy.resolution_m)};
}

PairMeasurement measure_pair(const PlacedPair& maps, const CandidatePair& pair, const CheckOptions& options) {
  PairSearches both(maps);
  PairMeasurement measurement;
  measurement.candidate = pair;
  PairEvidence& evidence = measurement.evidence;
  evidence.id = pair.id;
  evidence.kind = pair.kind;
  evidence.grain = grain_of(both.source.map(), both.target.map());
  evidence.conflict_margin_m = conflict_margin_m(both.source_centroids.search(), both.target_centroids.search());
  evidence.T_target_source = maps.target.T_world_submap.inverse() * maps.source.T_world_submap;
  const bool always_listed = pair.kind == PairKind::kSequential || pair.predicted_enough;
  if (!always_listed && !could_pass_gate(both, evidence.T_target_source, options.matching)) {
    measurement.listed = false;
    return measurement;
  }
  const TwoWaySample sample = sample_both_ways(both, evidence.T_target_source, options);
  const NearestBothWays near = near_surfaces(both, evidence.T_target_source);
  evidence.map = measure_at(both, evidence.T_target_source, sample, near, options);
  measurement.matched = sample.forward.matched();
  measurement.overlap = sample.forward.overlap();
  measurement.histogram = evidence.map.histogram;
  evidence.overlaps = sample.passes_gate(options.matching);
  if (!evidence.overlaps) {
    measurement.listed = always_listed;
    evidence.gate = gate_reason(sample, pair, options.matching);
    if (!pair.predicted_enough) return measurement;
  }
  const bool oicp = options.registration.method == RegistrationMethod::kOicp;
  const NearestVoxelSearch& from = (oicp ? both.source : both.source_centroids).search();
  const NearestVoxelSearch& onto = (oicp ? both.target : both.target_centroids).search();
  const RegistrationPrior prior = prior_of(pair, maps.target, options);
  if (evidence.overlaps) {
    evidence.common = common_surface(both, evidence.T_target_source, sample, near, options.matching);
    evidence.gap = measure_parallel_gap(both.source.map(), both.target.map(), evidence.T_target_source);
    evidence.registration = align_submaps(from, onto, evidence.T_target_source, options.registration, prior);
    measure_registered(both, options, evidence);
  }
  if (!oicp && options.registration.wide_translation_m > 0.0 &&
      (options.registration.always_search || basin_is_doubtful(evidence))) {
    RegistrationResult wide = align_widely(from, onto, evidence.T_target_source, options.registration, prior);
    if (wide.converged()) {
      evidence.registration = std::move(wide);
      measure_registered(both, options, evidence);
    }
  }
  if (oicp && evidence.registered && evidence.registered->score) {
    measurement.theta_oicp_per_m3 = evidence.registered->score->gamma_per_m3;
  }
  return measurement;
}

PairEvidence register_again(const PlacedPair& maps, const PairMeasurement& before, const Pose3& T_target_source_guess,
                            const CheckOptions& options) {
  PairSearches both(maps);
  PairEvidence evidence = before.evidence;
  evidence.registration =
      align_near(both.source_centroids.search(), both.target_centroids.search(), evidence.T_target_source,
                 T_target_source_guess, options.registration, prior_of(before.candidate, maps.target, options));
  measure_registered(both, options, evidence);
  return evidence;
}

PairResult pair_result(const PairMeasurement& measurement, const PairVerdict& verdict, const CheckOptions& options) {
  const PairEvidence& evidence = measurement.evidence;
  PairResult result;
  result.id = evidence.id;
  result.kind = evidence.kind;
  result.overlap = measurement.overlap;
  result.matched = measurement.matched;
  result.max_distance_m = options.matching.max_distance_m;
  result.histogram = measurement.histogram;
  result.score = evidence.map.score;
  result.theta_oicp_per_m3 = measurement.theta_oicp_per_m3;
  result.verdict = verdict;
  result.T_target_source = evidence.T_target_source;
  if (evidence.registered) {
    result.registered_score = evidence.registered->score;
    result.registered_histogram = evidence.registered->histogram;
    result.T_target_source_registered = evidence.registration->T_target_source;
    result.centre_target_m = evidence.registration->centre_target_m + evidence.registration->places_arm_m;
    result.covariance =
        constraint_covariance(*evidence.registration, is_rigid(*evidence.registration, options.judge), 1.0);
    result.trusted = verdict.verdict != Verdict::kUnverified && !verdict.without_registration;
  }
  const auto gamma_of = [](const std::optional<PairScore>& score) {
    return score ? score->gamma_per_m3 : std::nullopt;
  };
  const auto gamma = gamma_of(result.score);
  const auto theta = gamma_of(result.registered_score);
  if (gamma && theta) result.verified = *theta - *gamma;
  return result;
}

}  // namespace kilter
