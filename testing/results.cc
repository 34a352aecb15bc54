// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "testing/results.h"

namespace kilter::testing {
namespace {

PairResult& add_pair(Result& result, int source, int target) {
  PairResult& pair = result.pairs.emplace_back();
  pair.id = {SubmapId{source}, SubmapId{target}};
  const bool one_robot = result.submap(pair.id.source).robot == result.submap(pair.id.target).robot;
  pair.kind = !one_robot ? PairKind::kGlobal : source - target == 1 ? PairKind::kSequential : PairKind::kLocal;
  return pair;
}

PairScore score(double gamma_per_m3) {
  PairScore score;
  score.fit.parent = NormalParent{0.031, 0.042};
  score.fit.mu_t_m = 0.047;
  score.fit.var_t_m2 = 0.0011;
  score.gamma_per_m3 = gamma_per_m3;
  score.gamma_literal_per_m3 = gamma_per_m3 * 1.25;
  return score;
}

}  // namespace

Result result_of(const std::vector<RobotOf>& robots) {
  Result result;
  for (const RobotOf& robot : robots) {
    RobotSummary summary;
    summary.name = robot.name;
    summary.submaps = robot.submaps;
    summary.scans = 10 * static_cast<std::size_t>(robot.submaps);
    summary.path_length_m = 10.0 * robot.submaps;
    for (int i = 0; i < robot.submaps; ++i) {
      SubmapSummary submap;
      submap.id = {static_cast<int>(result.submaps.size())};
      submap.name = robot.name + "/" + std::to_string(i + 1);
      submap.robot = robot.name;
      submap.index = i + 1;
      submap.scans = ScanRange{10 * static_cast<std::size_t>(i), 10 * static_cast<std::size_t>(i) + 9};
      submap.T_world_submap = Pose3::from_translation(10.0 * i, 0.1 * submap.id.value, 1.0 / 3.0);
      submap.occupied = 41230;
      submap.bytes = 812345;
      result.submaps.push_back(std::move(submap));
    }
    result.robots.push_back(std::move(summary));
  }
  result.system.reason = "too little of what overlaps was decided";
  result.seconds = {{"submaps", 0.25}, {"pairs", 1.5}};
  return result;
}

PairResult& add_measured_pair(Result& result, int source, int target) {
  PairResult& pair = add_pair(result, source, target);
  pair.overlap = 0.41;
  pair.matched = 18234;
  pair.histogram = DistanceHistogram{0.01, {10, 7, 3, 0, 1}};
  pair.score = score(19342.0);
  pair.registered_score = score(20000.5);
  pair.theta_oicp_per_m3 = 19999.25;
  pair.verified = 658.5;
  pair.T_target_source = Pose3::from_translation(0.5, 0.0, 0.0);
  pair.T_target_source_registered = Pose3::from_translation(0.52, 0.0, 0.0);
  pair.covariance = Matrix6(Vector6(1e-6, 1e-6, 4e-6, 1e-8, 1e-8, 1e-8).asDiagonal());
  pair.trusted = true;
  PairVerdict& verdict = pair.verdict;
  verdict.verdict = Verdict::kConsistent;
  verdict.reason = "offset stays below the tolerance";
  verdict.evidence["displacement"] = {0.02, 0.01, -4.5};
  verdict.evidence["conflict"] = {0.001, std::nullopt, std::nullopt};
  verdict.offset_m = 0.02;
  verdict.offset_interval_m = {{0.01, 0.03}};
  verdict.offset_rad = 0.001;
  verdict.offset_vector_m = Eigen::Vector3d(0.02, 0.0, 0.0);
  verdict.gap_m = 0.01;
  verdict.minimum_detectable_m = 0.03;
  verdict.p_value = 0.9;
  verdict.log_odds = -6.0;
  verdict.p_inconsistent = 0.0025;
  return pair;
}

PairResult& add_empty_pair(Result& result, int source, int target) {
  PairResult& pair = add_pair(result, source, target);
  pair.verdict.reason = "too little overlap";
  return pair;
}

Result small_result() {
  Result result = result_of({{"a", 2}, {"b", 1}});
  add_measured_pair(result, 1, 0);
  PairResult& bad = add_measured_pair(result, 2, 0);
  bad.verdict.verdict = Verdict::kInconsistent;
  bad.verdict.reason = "offset exceeds the tolerance";
  bad.verdict.offset_m = 0.43;
  bad.verdict.offset_interval_m = {{0.39, 0.47}};
  bad.verdict.offset_rad = 0.03;
  bad.verdict.offset_vector_m = Eigen::Vector3d(0.0, -0.4, 0.15);
  bad.verdict.unobservable = {Vector6(1.0, 0.0, 0.0, 0.0, 0.0, 0.0)};
  bad.verdict.log_odds = 9.0;
  bad.verdict.p_inconsistent = 0.97;
  add_empty_pair(result, 2, 1);
  result.candidates = 3;
  result.too_little_overlap = 1;
  MapVerdict& system = result.system;
  system.state = MapState::kInconsistent;
  system.reason = "1 of 3 pairs disagrees by more than the tolerance";
  system.certificate_m = 0.22;
  system.certificate_excludes = {result.pairs[2].id};
  system.log_probability.total = -3.5;
  system.log_probability.per_pair = -1.75;
  system.log_probability.sequential["a"] = -0.0025;
  system.log_probability.global["a,b"] = -3.4975;
  system.tested = 3;
  system.inconsistent = 1;
  system.unverified = 1;
  system.decided.sequential = 1.0;
  system.decided.global["a,b"] = 0.5;
  return result;
}

}  // namespace kilter::testing
