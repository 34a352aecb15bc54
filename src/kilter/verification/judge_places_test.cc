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
  EXPECT_NEAR(*verdict.offset_m, 0.25, 1e-9);  // measured, and reported whatever the verdict
  EXPECT_TRUE(verdict.offset_interval_m);
  EXPECT_TRUE(verdict.minimum_detectable_m);
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

}  // namespace
}  // namespace kilter
