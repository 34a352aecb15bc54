// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "kilter/verification/judge.h"
#include "testing/moved_pair.h"

namespace kilter {
namespace {

using testing::judged;
using testing::kNull;
using testing::kRobots;
using testing::pair_moved;
using testing::verdict_of;

// A storey above fits as well and its neighbours ask for the same, but none of them is believed on its own.
TEST(JudgeNeighbours, AMoveThatFreeSpaceIsAgainstIsHeardIfBelievedNeighboursAskForIt) {
  PairEvidence pair = pair_moved(3.5, 0.01);
  pair.map.conflict = {};  // where the map has it there is nothing that both know
  pair.registration->support_start = 0;
  pair.registered->conflict = {{1000, 10}, {1000, 10}};
  pair.agreement.agreeing = 13;
  pair.agreement.agreeing_weight = 13.0;
  EXPECT_EQ(verdict_of(pair), Verdict::kUnverified);
  EXPECT_FALSE(judge_pair(pair, kNull, {}).p_value);
  pair.agreement.vouching = 1;
  EXPECT_EQ(verdict_of(pair), Verdict::kUnverified);
  pair.agreement.vouching = 2;
  const PairVerdict verdict = judge_pair(pair, kNull, {});
  EXPECT_EQ(verdict_of(pair), Verdict::kInconsistent);
  ASSERT_TRUE(verdict.without_registration) << "which is no reason to hand its own registration on";
  EXPECT_EQ(verdict.without_registration->find("2 pairs around it"), 0U) << *verdict.without_registration;
  EXPECT_FALSE(verdict.disagreement_most_m);
  EXPECT_NEAR(*verdict.log_odds, std::log(500.0 * 0.05 / 0.95), 1e-9);
  EXPECT_EQ(standing_of(verdict, {}), Standing::kDoubted) << "it vouches for nobody";
  pair.agreement.contradicting_weight = 3.0;
  pair.agreement.agreeing_weight = 1.0;
  pair.registration->searched = true;
  EXPECT_EQ(verdict_of(pair), Verdict::kUnverified) << "contradicted by more";
  EXPECT_NEAR(*judge_pair(pair, kNull, {}).log_odds, std::log(4.0 * 0.05 / 0.95), 0.01) << "and no more likely for it";
}

TEST(JudgeNeighbours, APairThatShowsNothingIsMovedByItsNeighbours) {
  PairEvidence pair = pair_moved(0.0, 0.01);
  pair.registration->stop = StopReason::kTooFewMatches;
  pair.registered.reset();
  pair.agreement.movers = 2;
  EXPECT_EQ(verdict_of(pair), Verdict::kUnverified);
  pair.agreement.movers = 3;
  pair.overlaps = false;  // as the map has it
  const PairVerdict verdict = judge_pair(pair, kNull, {});
  EXPECT_EQ(verdict_of(pair), Verdict::kInconsistent);
  EXPECT_NEAR(*verdict.log_odds, std::log(500.0 * 0.05 / 0.95), 1e-9);
  EXPECT_FALSE(verdict.offset_m);
}

TEST(JudgeNeighbours, OnlyWhatIsBelievedStandsForSomething) {
  EXPECT_EQ(standing_of(judge_pair(pair_moved(0.02, 0.005), kNull, {}), {}), Standing::kStays);
  EXPECT_EQ(standing_of(judge_pair(pair_moved(0.25, 0.01), kNull, {}), {}), Standing::kMoves);
  EXPECT_EQ(standing_of(judge_pair(pair_moved(0.11, 0.01), kNull, {}), {}), Standing::kDoubted);
  PairEvidence bent = pair_moved(0.02, 0.005);
  bent.registration->bend.rms_m = 0.4;
  EXPECT_EQ(standing_of(judge_pair(bent, kNull, {}), {}), Standing::kDoubted) << "it asks for no move";
  bent = pair_moved(0.11, 0.01);
  bent.registration->bend.rms_m = 0.4;
  EXPECT_EQ(standing_of(judge_pair(bent, kNull, {}), {}), Standing::kDoubted) << "what is sure is the bend";
}

// Moved by less than the tolerance, where no side is seen by both: whoever vouches, there is nothing to compare.
TEST(JudgeNeighbours, ThePlacesOfAPairThatStaysMayStillDiffer) {
  PairEvidence pair = pair_moved(0.02, 0.005);
  pair.common = CommonSurface{.matched = 125, .overlap = 0.03};
  pair.agreement.vouching = 5;
  EXPECT_EQ(verdict_of(pair), Verdict::kUnverified);
  EXPECT_EQ(judge_pair(pair, kNull, {}).reason.find("too little overlap"), 0U);
  PairEvidence moved = pair_moved(3.0, 0.01);
  moved.common = pair.common;
  EXPECT_EQ(verdict_of(moved), Verdict::kUnverified);
  moved.agreement.vouching = 2;
  EXPECT_EQ(verdict_of(moved), Verdict::kInconsistent);
  moved.registration->searched = true;
  moved.agreement.contradicting_weight = 3.0;
  EXPECT_EQ(judge_pair(moved, kNull, {}).reason.find("too little overlap"), 0U) << "others contradict it";
}

// 0.002 is no discovery of its own in a map of consistent pairs.
TEST(JudgeNeighbours, OneAmongManyConsistentPairsStaysUndecided) {
  PairEvidence pair = pair_moved(3.5, 0.01);
  pair.map.conflict = {};
  pair.registration->support_start = 0;
  pair.registered->conflict = {{1000, 10}, {1000, 10}};
  pair.agreement.vouching = 2;
  std::vector<JudgedPair> pairs = {judged(pair)};
  for (int i = 2; i < 10; ++i) pairs.push_back(judged(pair_moved(0.02, 0.005, PairKind::kGlobal, i)));
  (void)judge_map(pairs, kRobots, {});
  EXPECT_EQ(pairs[0].verdict.verdict, Verdict::kUnverified);
  EXPECT_NE(pairs[0].verdict.reason.find("conflicts more there"), std::string::npos);
}

}  // namespace
}  // namespace kilter
