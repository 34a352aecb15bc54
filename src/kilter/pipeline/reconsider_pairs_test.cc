// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/pipeline/reconsider_pairs.h"

#include <gtest/gtest.h>

#include <deque>
#include <utility>
#include <vector>

#include "kilter/verification/witnesses.h"
#include "testing/moved_pair.h"

namespace kilter {
namespace {

using testing::pair_moved;

// Submaps 0 to 2 of one robot, 3 to 5 of another that drives beside it, ten metres apart.
std::vector<SubmapNode> two_journeys() {
  std::vector<SubmapNode> nodes(6);
  for (int i = 0; i < 6; ++i) {
    SubmapNode& node = nodes[static_cast<std::size_t>(i)];
    node.id = {i};
    node.robot = i / 3;
    node.index = i % 3;
    node.path_start_m = 10.0 * node.index;
    node.path_end_m = node.path_start_m + 10.0;
    node.T_world_submap = Pose3::from_translation(node.path_start_m, 0.0, 0.0);
  }
  return nodes;
}

PairMeasurement moved(const std::vector<SubmapNode>& nodes, int source, int target, double shift_m) {
  PairMeasurement measured;
  measured.evidence = pair_moved(0.0, 0.01, PairKind::kGlobal, source);
  measured.evidence.id = {{source}, {target}};
  RegistrationResult& registration = *measured.evidence.registration;
  const Pose3& T_world_target = nodes[static_cast<std::size_t>(target)].T_world_submap;
  const Pose3& T_world_source = nodes[static_cast<std::size_t>(source)].T_world_submap;
  measured.evidence.T_target_source = T_world_target.inverse() * T_world_source;
  registration.T_target_source =
      T_world_target.inverse() * (Pose3::from_translation(shift_m, 0.0, 0.0) * T_world_source);
  return measured;
}

// What is heard of each pair, in order: those that vouch, and those that would move it.
std::vector<std::pair<int, int>> heard(const std::vector<SubmapNode>& nodes, std::deque<PairMeasurement> measured,
                                       const std::vector<Standing>& standings, const CheckOptions& options = {}) {
  hear_neighbours(nodes, standings, options, measured);
  std::vector<std::pair<int, int>> said;
  for (const PairMeasurement& pair : measured) {
    said.emplace_back(pair.evidence.agreement.vouching, pair.evidence.agreement.movers);
  }
  return said;
}

TEST(HearNeighbours, OfDoubtedPairsAndOfThoseThatWereNotRegistered) {
  const std::vector<SubmapNode> nodes = two_journeys();
  std::deque<PairMeasurement> measured = {moved(nodes, 3, 0, 2.0), moved(nodes, 4, 0, 2.0), moved(nodes, 4, 1, 2.0),
                                          moved(nodes, 5, 1, 2.0), moved(nodes, 3, 1, 0.0)};
  PairEvidence& failed = measured.back().evidence;
  failed.registered.reset();
  failed.registration->stop = StopReason::kTooFewMatches;
  using enum Standing;
  const std::vector<Standing> standings = {kMoves, kMoves, kMoves, kDoubted, kDoubted};
  using Heard = std::vector<std::pair<int, int>>;
  EXPECT_EQ(heard(nodes, measured, standings), (Heard{{0, 0}, {2, 0}, {0, 0}, {0, 0}, {0, 3}}))
      << "some of its source and of its target: the second has both, the last one's failed";
  failed.overlaps = false;
  EXPECT_EQ(heard(nodes, measured, standings).back().second, 0) << "perhaps they saw nothing in common";
  measured.back().candidate.predicted_enough = true;
  EXPECT_EQ(heard(nodes, measured, standings).back().second, 3);
  CheckOptions papers;
  papers.registration.method = RegistrationMethod::kOicp;
  EXPECT_EQ(heard(nodes, measured, standings, papers), Heard(5));
}

TEST(JudgeAmongNeighbours, TwoThatAreBelievedDecideTheOneBetweenThem) {
  const std::vector<SubmapNode> nodes = two_journeys();
  std::deque<PairMeasurement> measured = {moved(nodes, 3, 0, 2.0), moved(nodes, 4, 1, 2.0), moved(nodes, 4, 0, 2.0)};
  RegistrationResult& doubted = *measured.back().evidence.registration;
  doubted.support_end = doubted.support_start;
  const auto judged = [&](std::ptrdiff_t count) {
    std::deque<PairMeasurement> last(measured.end() - count, measured.end());
    return judge_among_neighbours(nodes, {}, {}, last);
  };
  EXPECT_FALSE(judged(1)[0].p_value);
  EXPECT_FALSE(judged(2)[1].p_value) << "one side alone";
  const std::vector<PairVerdict> all = judged(3);
  for (const std::size_t believed : {0U, 1U}) {
    ASSERT_TRUE(all[believed].p_value);
    EXPECT_LT(*all[believed].p_value, 1e-4);
    EXPECT_FALSE(all[believed].without_registration);
    EXPECT_FALSE(all[believed].evidence.contains("agreeing"));
  }
  EXPECT_EQ(all[2].p_value, kDeniedByNeighbours);
  ASSERT_TRUE(all[2].evidence.at("disagreement").log_ratio);
  EXPECT_EQ(all[2].evidence.at("agreeing").log_ratio, all[2].evidence.at("disagreement").log_ratio);
  EXPECT_TRUE(all[2].without_registration);
}

}  // namespace
}  // namespace kilter
