// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/pipeline/reconsider_pairs.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kilter {
namespace {

// Registrations that leave this share of conflict are no witnesses.
constexpr double kWitnessConflict = 0.05;
constexpr double kHalfAsGood = 0.5;

// The middle of where a submap's sensor was, as the map has it.
Eigen::Vector3d middle_world_m(const SubmapNode& node) {
  Eigen::Vector3d sum_m = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& origin_m : node.origins_m) sum_m += origin_m;
  return node.T_world_submap * (sum_m / static_cast<double>(std::max<std::size_t>(node.origins_m.size(), 1)));
}

// Where a pair lies on both journeys, without what it asks for.
Correction place_of(std::span<const SubmapNode> nodes, const PairEvidence& evidence) {
  const SubmapNode& source = nodes[static_cast<std::size_t>(evidence.id.source.value)];
  const SubmapNode& target = nodes[static_cast<std::size_t>(evidence.id.target.value)];
  Correction correction;
  correction.id = evidence.id;
  correction.source_robot = source.robot;
  correction.target_robot = target.robot;
  correction.source_path_m = 0.5 * (source.path_start_m + source.path_end_m);
  correction.target_path_m = 0.5 * (target.path_start_m + target.path_end_m);
  correction.centre_world_m = 0.5 * (middle_world_m(source) + middle_world_m(target));
  return correction;
}

Correction correction_of(std::span<const SubmapNode> nodes, const PairEvidence& evidence) {
  const RegistrationResult& registration = *evidence.registration;
  const Pose3& T_world_source = nodes[static_cast<std::size_t>(evidence.id.source.value)].T_world_submap;
  const Pose3& T_world_target = nodes[static_cast<std::size_t>(evidence.id.target.value)].T_world_submap;
  Correction correction = place_of(nodes, evidence);
  correction.T_world_correction = T_world_target * registration.T_target_source * T_world_source.inverse();
  correction.centre_world_m = T_world_source * (registration.T_target_source.inverse() * registration.centre_target_m);
  correction.sigma_m = std::sqrt(registration.covariance_centre.topLeftCorner<3, 3>().trace());
  correction.sigma_rad = std::sqrt(registration.covariance_centre.bottomRightCorner<3, 3>().trace());
  const bool witness = evidence.registered->conflict.share() <= kWitnessConflict;
  correction.weight = witness ? 1.0 - registration.ambiguity.value_or(0.0) : 0.0;
  return correction;
}

struct Corrections {
  std::vector<Correction> all;
  std::vector<std::size_t> pairs;  // whose they are
  std::vector<Agreement> agreements;
};

AgreementOptions agreement_options(const CheckOptions& options) {
  return {.drift_per_metre = options.pairing.drift_per_metre};
}

Corrections corrections_of(std::span<const SubmapNode> nodes, const std::deque<PairMeasurement>& measured) {
  Corrections corrections;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    if (!measured[i].evidence.registered) continue;
    corrections.all.push_back(correction_of(nodes, measured[i].evidence));
    corrections.pairs.push_back(i);
  }
  return corrections;
}

Corrections compared_corrections_of(std::span<const SubmapNode> nodes, const std::deque<PairMeasurement>& measured,
                                    const AgreementOptions& options) {
  Corrections corrections = corrections_of(nodes, measured);
  corrections.agreements = compare_corrections({corrections.all, options});
  return corrections;
}

void store_agreements(const Corrections& corrections, std::deque<PairMeasurement>& measured) {
  for (std::size_t k = 0; k < corrections.pairs.size(); ++k) {
    measured[corrections.pairs[k]].evidence.agreement = corrections.agreements[k];
  }
}

bool wants_another_try(const PairEvidence& evidence, const CandidatePair& candidate) {
  if (!evidence.registered) return evidence.overlaps || candidate.predicted_enough;
  if (!evidence.registration->searched) return false;
  const bool unclear = evidence.registration->ambiguous() || evidence.registered->conflict.share() > kWitnessConflict;
  return evidence.agreement.contradicted() || (unclear && evidence.agreement.agreeing == 0);
}

bool is_worth_keeping(const PairEvidence& found, const PairEvidence& before) {
  if (!found.registered || found.registered->conflict.share() > kWitnessConflict) return false;
  const double old_worth = before.registered ? std::max(before.registration->worth, 0.0) : 0.0;
  return found.registration->worth > kHalfAsGood * old_worth;
}

}  // namespace

Expected<void> reconsider_pairs(std::span<const SubmapNode> nodes, SubmapStore& store, const CheckOptions& options,
                                const RunContext& run, std::deque<PairMeasurement>& measured) {
  if (options.registration.method == RegistrationMethod::kOicp) return {};
  const AgreementOptions agreement = agreement_options(options);
  const Corrections first = compared_corrections_of(nodes, measured, agreement);
  store_agreements(first, measured);
  struct Try {
    std::size_t pair;
    Pose3 T_target_source;
  };
  const CorrectionIndex index(first.all, agreement);
  std::vector<Try> tries;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const PairEvidence& evidence = measured[i].evidence;
    if (!wants_another_try(evidence, measured[i].candidate)) continue;
    const auto suggested = suggest_correction(index, first.agreements, place_of(nodes, evidence));
    if (!suggested) continue;
    const Pose3& T_world_source = nodes[static_cast<std::size_t>(evidence.id.source.value)].T_world_submap;
    const Pose3& T_world_target = nodes[static_cast<std::size_t>(evidence.id.target.value)].T_world_submap;
    tries.push_back({i, T_world_target.inverse() * first.all[*suggested].T_world_correction * T_world_source});
  }
  std::vector<PairId> ids;
  ids.reserve(tries.size());
  for (const Try& one : tries) ids.push_back(measured[one.pair].evidence.id);
  Expected<void> done = for_each_pair(nodes, store, ids, run, [&](std::size_t k, const PlacedPair& maps) {
    PairMeasurement& pair = measured[tries[k].pair];  // each is tried once
    PairEvidence found = register_again(maps, pair, tries[k].T_target_source, options);
    if (is_worth_keeping(found, pair.evidence)) pair.evidence = std::move(found);
  });
  if (!done) return done;
  store_agreements(compared_corrections_of(nodes, measured, agreement), measured);
  return {};
}

void hear_neighbours(std::span<const SubmapNode> nodes, std::span<const Standing> standings,
                     const CheckOptions& options, std::deque<PairMeasurement>& measured) {
  if (options.registration.method == RegistrationMethod::kOicp) return;
  const Corrections corrections = corrections_of(nodes, measured);
  std::vector<Standing> of_corrections;
  of_corrections.reserve(corrections.pairs.size());
  for (const std::size_t i : corrections.pairs) of_corrections.push_back(standings[i]);
  const double tolerance_m = options.judge.tolerance_m;
  const CorrectionIndex index(corrections.all, agreement_options(options));
  const std::vector<int> vouching = count_vouching(index, of_corrections, tolerance_m);
  for (std::size_t k = 0; k < vouching.size(); ++k) {
    measured[corrections.pairs[k]].evidence.agreement.vouching = vouching[k];
  }
  for (PairMeasurement& pair : measured) {
    PairEvidence& evidence = pair.evidence;
    if (evidence.registered || !(evidence.overlaps || pair.candidate.predicted_enough)) continue;
    evidence.agreement.movers = count_movers(index, of_corrections, place_of(nodes, evidence), tolerance_m);
  }
}

std::vector<PairVerdict> judge_among_neighbours(std::span<const SubmapNode> nodes, const MapNull& null,
                                                const CheckOptions& options, std::deque<PairMeasurement>& measured) {
  std::vector<PairVerdict> verdicts;
  std::vector<Standing> standings;
  for (const PairMeasurement& pair : measured) {
    verdicts.push_back(judge_pair(pair.evidence, null, options.judge));
    standings.push_back(standing_of(verdicts.back(), options.judge));
  }
  hear_neighbours(nodes, standings, options, measured);
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const PairEvidence& evidence = measured[i].evidence;
    const Agreement& heard = evidence.agreement;
    if (heard.vouching > 0 || heard.movers > 0) verdicts[i] = judge_pair(evidence, null, options.judge);
  }
  return verdicts;
}

}  // namespace kilter
