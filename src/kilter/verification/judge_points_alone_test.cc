// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "kilter/verification/judge.h"
#include "testing/moved_pair.h"

namespace kilter {
namespace {

using testing::judged;
using testing::kNull;
using testing::pair_moved;
using testing::verdict_of;

// To points alone a wall's other face is the wall: twice as much that fits is no witness of a move, nor are a few of
// those around it that fell into the same aisle.
TEST(PointsAlone, AskForMoreThanScans) {
  const auto without_free_space = [](PairEvidence pair) {
    pair.map.conflict = pair.registered->conflict = {};
    return pair;
  };
  PairEvidence pair = pair_moved(0.3, 0.01);
  pair.registration->support_start = 1000;
  pair.registration->support_end = 2000;
  EXPECT_EQ(verdict_of(pair), Verdict::kInconsistent);
  EXPECT_EQ(verdict_of(without_free_space(pair)), Verdict::kUnverified);
  pair.registration->support_end = 4000;
  EXPECT_EQ(verdict_of(without_free_space(pair)), Verdict::kInconsistent);
  pair.registration->searched = true;
  pair.agreement.agreeing = 9;
  pair.agreement.agreeing_weight = 5.0;
  pair.agreement.contradicting = 25;
  pair.agreement.contradicting_weight = 15.0;
  EXPECT_TRUE(judge_pair(pair, kNull, {}).reason.find("ask for another correction") == std::string::npos);
  const PairVerdict alone = judge_pair(without_free_space(pair), kNull, {});
  EXPECT_NE(alone.reason.find("25 ask for another correction"), std::string::npos) << alone.reason;
}

// Theta follows how much overlaps, so a pair of little overlap lies below the others; that it was left for the wrong
// place it can tell only of one that was left.
TEST(PointsAlone, ThatMovedMustAgreeAsWellAsTheMapsOtherPairs) {
  const auto verdict_at = [](double offset_m, double log10_theta) {
    PairEvidence pair = pair_moved(offset_m, 0.01);
    pair.registered->conflict = {};
    pair.registration->support_start = 100;
    pair.registration->support_end = 1000;
    pair.registered->score.emplace().log10_gamma = log10_theta;
    return verdict_of(pair);
  };
  EXPECT_EQ(verdict_at(0.4, 1.9), Verdict::kInconsistent);
  EXPECT_EQ(verdict_at(0.4, 1.2), Verdict::kUnverified);
  EXPECT_EQ(verdict_at(0.01, 1.9), Verdict::kConsistent);
  EXPECT_EQ(verdict_at(0.01, 1.2), Verdict::kConsistent);
}

// A submap that is bent inside shows in when its scans saw what, and in free space.
TEST(PointsAlone, CannotBeSureThatNothingIsBent) {
  const auto log_odds_of = [](double offset_m, bool points_alone) {
    PairEvidence pair = pair_moved(offset_m, 0.01);
    pair.registration->support_start = 100;
    pair.registration->support_end = 1000;
    if (points_alone) pair.registered->conflict = {};
    return *judged(pair).verdict.log_odds;
  };
  EXPECT_GT(log_odds_of(0.01, true), log_odds_of(0.01, false) + 10.0);
  EXPECT_NEAR(log_odds_of(0.01, true), std::log(0.05) + std::log(0.05 / 0.95), 0.01);
  EXPECT_EQ(log_odds_of(0.4, true), log_odds_of(0.4, false));
}

}  // namespace
}  // namespace kilter
