// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "kilter/verification/judge.h"
#include "testing/moved_pair.h"

namespace kilter {
namespace {

using testing::kNull;
using testing::pair_moved;
using testing::verdict_of;

TEST(JudgePlaces, WhereNoSideIsSeenByBothAndNothingConflictsNothingIsCompared) {
  PairEvidence pair = pair_moved(0.25, 0.01);  // a floor, laid on the ceiling under it
  pair.common = CommonSurface{.matched = 125, .overlap = 0.03};
  const PairVerdict verdict = judge_pair(pair, kNull, {});
  EXPECT_EQ(verdict.verdict, Verdict::kUnverified);
  EXPECT_EQ(verdict.reason.find("too little overlap"), 0U) << verdict.reason;
  EXPECT_FALSE(verdict.p_value);
  EXPECT_FALSE(verdict.offset_m);
  EXPECT_TRUE(may_show_different_places(pair, kNull));
  pair.map.conflict = {{1000, 300}, {1000, 300}};  // a wall that is there twice stands in free space
  pair.registered->conflict = {{1000, 20}, {1000, 20}};
  EXPECT_FALSE(may_show_different_places(pair, kNull));
  EXPECT_EQ(verdict_of(pair), Verdict::kInconsistent);
}

TEST(JudgePlaces, LittleSeenByBothIsJudgedButNotWaitedFor) {
  PairEvidence pair = pair_moved(0.10, 0.01);
  pair.common = CommonSurface{.matched = 800, .overlap = 0.08, .any = true};
  EXPECT_TRUE(may_show_different_places(pair, kNull));
  EXPECT_NE(judge_pair(pair, kNull, {}).reason.find("does not wait"), std::string::npos);
  PairEvidence sure = pair_moved(0.25, 0.01);
  sure.common = pair.common;
  const PairVerdict other_floor = judge_pair(sure, kNull, {});  // what fits may be a floor laid on a ceiling
  EXPECT_EQ(other_floor.verdict, Verdict::kUnverified);
  EXPECT_NE(other_floor.reason.find("the places may differ"), std::string::npos) << other_floor.reason;
  EXPECT_FALSE(other_floor.p_value);
  EXPECT_NEAR(*other_floor.log_odds, std::log(4.0 * 0.05 / 0.95), 0.01);
  sure.common = CommonSurface{.matched = 6000, .overlap = 0.6, .any = true, .enough = true};
  EXPECT_FALSE(may_show_different_places(sure, kNull));
  EXPECT_EQ(verdict_of(sure), Verdict::kInconsistent);
}

// Surfaces that lie apart stand in each other's free space. Where they do not, other surfaces may be what fits.
TEST(JudgePlaces, AMoveThatFreeSpaceKnowsNothingOfNeedsMostOfASideInCommon) {
  PairEvidence pair = pair_moved(0.25, 0.01);
  pair.common = CommonSurface{.matched = 3000, .overlap = 0.4, .any = true, .enough = true};
  pair.map.conflict = {{1000, 20}, {1000, 20}};  // as much as usual in this map
  const PairVerdict silent = judge_pair(pair, kNull, {});
  EXPECT_FALSE(may_show_different_places(pair, kNull)) << "the map waits for it";
  EXPECT_EQ(silent.verdict, Verdict::kUnverified);
  EXPECT_NE(silent.reason.find("the places may differ"), std::string::npos) << silent.reason;
  EXPECT_NEAR(*silent.log_odds, std::log(4.0 * 0.05 / 0.95), 0.01);
  pair.map.conflict = {{1000, 40}, {1000, 40}};
  EXPECT_EQ(verdict_of(pair), Verdict::kInconsistent);
  pair.map.conflict = {{100, 2}, {100, 2}};  // hardly known
  EXPECT_EQ(verdict_of(pair), Verdict::kInconsistent);
  pair.map.conflict = {{1000, 20}, {1000, 20}};
  pair.common->overlap = 0.6;
  EXPECT_EQ(verdict_of(pair), Verdict::kInconsistent);
}

// A storey above fits as well and its neighbours ask for the same, but none of them is believed on its own.
TEST(JudgePlaces, AMoveThatFreeSpaceIsAgainstIsHeardIfBelievedNeighboursAskForIt) {
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
  EXPECT_EQ(standing_of(verdict, {}), Standing::kDoubted) << "it vouches for nobody";
  pair.agreement.contradicting_weight = 3.0;
  pair.agreement.agreeing_weight = 1.0;
  pair.registration->searched = true;
  EXPECT_EQ(verdict_of(pair), Verdict::kUnverified) << "contradicted by more";
}

TEST(JudgePlaces, APairThatShowsNothingIsMovedByItsNeighbours) {
  PairEvidence pair = pair_moved(0.0, 0.01);
  pair.registration->stop = StopReason::kTooFewMatches;
  pair.registered.reset();
  pair.agreement.vouching = 2;
  EXPECT_EQ(verdict_of(pair), Verdict::kUnverified);
  pair.agreement.vouching = 3;
  const PairVerdict verdict = judge_pair(pair, kNull, {});
  EXPECT_EQ(verdict_of(pair), Verdict::kInconsistent);
  EXPECT_NEAR(*verdict.log_odds, std::log(500.0 * 0.05 / 0.95), 1e-9);
  EXPECT_FALSE(verdict.offset_m);
}

TEST(JudgePlaces, OnlyWhatIsBelievedStandsForSomething) {
  EXPECT_EQ(standing_of(judge_pair(pair_moved(0.02, 0.005), kNull, {}), {}), Standing::kStays);
  EXPECT_EQ(standing_of(judge_pair(pair_moved(0.25, 0.01), kNull, {}), {}), Standing::kMoves);
  EXPECT_EQ(standing_of(judge_pair(pair_moved(0.11, 0.01), kNull, {}), {}), Standing::kDoubted);
  PairEvidence bent = pair_moved(0.02, 0.005);
  bent.registration->bend.rms_m = 0.4;
  EXPECT_EQ(standing_of(judge_pair(bent, kNull, {}), {}), Standing::kDoubted) << "it asks for no move";
}

}  // namespace
}  // namespace kilter
