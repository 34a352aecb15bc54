// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/pipeline/reconsider_pairs.h"

#include <gtest/gtest.h>

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

TEST(VouchingFor, CountsForDoubtedPairsAndForThoseThatWereNotRegistered) {
  const std::vector<SubmapNode> nodes = two_journeys();
  std::vector<PairMeasurement> measured = {moved(nodes, 3, 0, 2.0), moved(nodes, 4, 0, 2.0), moved(nodes, 4, 1, 2.0),
                                           moved(nodes, 5, 1, 2.0), moved(nodes, 3, 1, 0.0)};
  PairEvidence& failed = measured.back().evidence;
  failed.registered.reset();
  failed.registration->stop = StopReason::kTooFewMatches;
  using enum Standing;
  const std::vector<Standing> standings = {kMoves, kMoves, kMoves, kDoubted, kDoubted};
  const CheckOptions options;
  EXPECT_EQ(vouching_for(nodes, measured, standings, options), (std::vector{2, 2, 2, 3, 3}));
  failed.overlaps = false;
  EXPECT_EQ(vouching_for(nodes, measured, standings, options).back(), 0) << "perhaps they saw nothing in common";
  measured.back().candidate.predicted_enough = true;
  EXPECT_EQ(vouching_for(nodes, measured, standings, options).back(), 3);
}

}  // namespace
}  // namespace kilter
