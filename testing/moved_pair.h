// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "kilter/verification/judge.h"

namespace kilter::testing {

/// A well-matched pair whose registration moved it by `offset_m` along x with the given certainty.
inline PairEvidence pair_moved(double offset_m, double sigma_m, PairKind kind = PairKind::kGlobal, int source = 1) {
  PairEvidence pair;
  pair.id = {{source}, {0}};
  pair.kind = kind;
  pair.overlaps = true;
  pair.map.matched = 5000;
  pair.map.overlap = 0.6;
  pair.map.mean_distance_m = 0.05 + offset_m;
  pair.map.conflict = {{1000, 20}, {1000, 20}};
  RegistrationResult registration;
  registration.stop = StopReason::kConverged;
  registration.T_target_source = Pose3::from_translation(offset_m, 0.0, 0.0);
  registration.scatter_m2 = Eigen::Vector3d(9.0, 9.0, 1.0).asDiagonal();
  Vector6 variances = Vector6::Constant(1e-6);
  variances.head<3>().setConstant(sigma_m * sigma_m);
  registration.covariance_measured = variances.asDiagonal();
  registration.covariance_centre = registration.covariance_measured;
  registration.support_start = 2000;
  registration.support_end = 4000;
  pair.registration = registration;
  pair.registered = pair.map;
  pair.registered->mean_distance_m = 0.05;
  return pair;
}

/// A map of two robots whose good pairs are like this.
inline const std::vector<std::string> kRobots = {"a", "b"};
inline const MapNull kNull = {2.0, 0.1, 2.0, 0.1, 0.02, 0.01, 10, 10};

/// In that map.
inline JudgedPair judged(const PairEvidence& pair, const JudgeOptions& options = {}) {
  return {
      pair.id, pair.kind, pair.overlaps, pair.kind == PairKind::kGlobal ? 1 : 0, 0, judge_pair(pair, kNull, options)};
}

/// With nothing else in it.
inline Verdict verdict_of(const PairEvidence& pair, const JudgeOptions& options = {}) {
  std::vector<JudgedPair> pairs = {judged(pair, options)};
  (void)judge_map(pairs, kRobots, options);
  return pairs[0].verdict.verdict;
}

}  // namespace kilter::testing
