// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/verification/judge.h"
#include "kilter/base/rng.h"

#include <gtest/gtest.h>

#include <cmath>

#include "testing/moved_pair.h"

namespace kilter {
namespace {

using testing::judged;
using testing::kNull;
using testing::kRobots;
using testing::pair_moved;
using testing::verdict_of;

TEST(JudgePair, OffsetAgainstToleranceDecides) {
  EXPECT_EQ(verdict_of(pair_moved(0.20, 0.01)), Verdict::kInconsistent);
  EXPECT_EQ(verdict_of(pair_moved(0.05, 0.01)), Verdict::kConsistent);
  EXPECT_EQ(verdict_of(pair_moved(0.05, 0.005), {.tolerance_m = 0.03}), Verdict::kInconsistent);
  EXPECT_EQ(verdict_of(pair_moved(0.10, 0.01)), Verdict::kUnverified);
  EXPECT_EQ(verdict_of(pair_moved(0.05, 0.10)), Verdict::kUnverified);
}

// Moved by so much, where cells of half a metre leave a tenth of one open along each axis.
PairEvidence cells_moved(double offset_m) {
  PairEvidence pair = pair_moved(offset_m, 0.1);
  pair.grain = {.edge_m = 0.5, .cell_m = 0.5, .variance_m2 = 0.25 / 6.0, .most_m = 0.5, .voxels_per_cell = 125.0};
  pair.conflict_margin_m = 1.0;
  pair.registration->covariance_cells = pair.registration->covariance_measured;
  return pair;
}

// Cells larger than what searches reach: conflict was counted within that, and is tolerated by it.
TEST(JudgePair, ConflictIsToleratedByTheMarginThatItWasCountedWith) {
  PairEvidence pair = cells_moved(0.4);
  pair.map.conflict = {{200000, 20000}, {200000, 20000}};
  pair.registered->conflict = {{200000, 2000}, {200000, 2000}};
  EXPECT_LT(*judged(pair, {.tolerance_m = 0.4}).verdict.p_value, 0.03);
  pair.conflict_margin_m = 0.5;
  EXPECT_GT(*judged(pair, {.tolerance_m = 0.4}).verdict.p_value, 0.03);
}

TEST(JudgePair, WhatCellsHideIsNeitherAFaultNorRuledOut) {
  EXPECT_EQ(verdict_of(cells_moved(0.2)), Verdict::kUnverified);
  EXPECT_EQ(verdict_of(cells_moved(1.0)), Verdict::kInconsistent);
  EXPECT_EQ(verdict_of(cells_moved(0.1), {.tolerance_m = 0.5}), Verdict::kConsistent);
  const PairVerdict hidden = judge_pair(cells_moved(0.05), kNull, {});
  EXPECT_EQ(hidden.verdict, Verdict::kUnverified);
  EXPECT_NE(
      hidden.reason.find("centres of cells of 0.5 m, which leave 17.3 cm open (one sigma), too much for the tolerance"),
      std::string::npos)
      << hidden.reason;
  EXPECT_NE(judge_pair(cells_moved(0.2), kNull, {}).reason.find("cells of 0.5 m"), std::string::npos);
}

TEST(JudgePair, NothingIsConsistentThatThePriorAndTheMeasurementLeaveLikelyNotTo) {
  const PairEvidence pair = pair_moved(0.06, 0.02);
  EXPECT_EQ(verdict_of(pair), Verdict::kConsistent);
  const PairVerdict believed = judge_pair(pair, kNull, {.prior_inconsistent = 0.97});
  EXPECT_GT(*believed.p_inconsistent, 0.05);
  EXPECT_EQ(believed.verdict, Verdict::kUnverified);
  EXPECT_NE(believed.reason.find("0.97 of all pairs"), std::string::npos) << believed.reason;
}

// A doubted move of 0.6 m, and free space that begins to speak of the map's pose, too.
TEST(JudgePair, MoreThatConflictsNeverMakesItLessLikely) {
  double last = 0.0;
  for (std::size_t share = 0; share <= 400; share += 10) {
    PairEvidence pair = pair_moved(0.6, 0.01);
    pair.registration->ambiguity = 0.9;
    pair.map.conflict = {{1000, share}, {1000, share}};
    const double p = *judge_pair(pair, kNull, {}).p_inconsistent;
    EXPECT_GE(p, last - 1e-12) << share;
    last = p;
  }
  EXPECT_GT(last, 0.99);
}

TEST(JudgePair, OffsetIsReportedWhateverTheVerdict) {
  const PairVerdict verdict = judge_pair(pair_moved(0.05, 0.01), {}, {});
  EXPECT_NEAR(*verdict.offset_m, 0.05, 1e-9);
  EXPECT_LE((*verdict.offset_interval_m)[0], 0.05);
  EXPECT_GE((*verdict.offset_interval_m)[1], 0.05);
  EXPECT_LT(*verdict.p_inconsistent, 0.05);
  EXPECT_GT(*verdict.minimum_detectable_m, 0.0);
}

TEST(JudgePair, TheGapBetweenDoubledWallsStandsBesideTheVerdict) {
  PairEvidence pair = pair_moved(0.05, 0.01);
  EXPECT_FALSE(judge_pair(pair, {}, {}).gap_m);
  pair.gap = ParallelGap{.gap_m = 0.049, .sigma_m = 0.01};
  const PairVerdict verdict = judge_pair(pair, {}, {});
  EXPECT_EQ(verdict.gap_m, 0.049);
  EXPECT_NEAR(*verdict.evidence.at("gap_m").null, 0.0258, 1e-4);
  PairEvidence far = pair_moved(1.4, 0.01);
  far.gap = pair.gap;  // of the floor: the walls are farther apart than gaps are looked for
  EXPECT_FALSE(judge_pair(far, {}, {}).gap_m);
}

TEST(JudgePair, WithoutOverlapItIsNeverDecided) {
  PairEvidence pair = pair_moved(0.0, 0.01);
  pair.overlaps = false;
  pair.gate = "too little overlap";
  pair.registration.reset();
  pair.registered.reset();
  EXPECT_EQ(judge_pair(pair, {}, {}).verdict, Verdict::kUnverified);
  EXPECT_EQ(judge_pair(pair, {}, {}).reason, "too little overlap");
  EXPECT_FALSE(judge_pair(pair, {}, {}).offset_m.has_value());
}

TEST(JudgePair, FailedRegistrationIsUnverifiedAndSaysHow) {
  PairEvidence pair = pair_moved(0.0, 0.01);
  pair.registration->stop = StopReason::kMaxIterations;
  pair.registered.reset();
  const PairVerdict verdict = judge_pair(pair, {}, {});
  EXPECT_EQ(verdict.verdict, Verdict::kUnverified);
  EXPECT_NE(verdict.reason.find("did not settle"), std::string::npos);
}

TEST(JudgePair, AnOptimumThatStillConflictsIsNotBelieved) {
  PairEvidence pair = pair_moved(0.02, 0.01);
  pair.registered->conflict = {{1000, 300}, {1000, 300}};
  EXPECT_EQ(verdict_of(pair), Verdict::kUnverified);
  PairEvidence lost = pair_moved(0.3, 0.01);
  lost.registered->overlap = 0.3;
  EXPECT_EQ(verdict_of(lost), Verdict::kUnverified);
  PairEvidence no_better = pair_moved(0.3, 0.01);
  no_better.registration->support_end = no_better.registration->support_start;
  EXPECT_EQ(verdict_of(no_better), Verdict::kUnverified);
}

// A pair that registration hardly moves, and whose parts stay apart by `rms_m` inside.
PairEvidence pair_bent(double rms_m) {
  PairEvidence pair = pair_moved(0.02, 0.005);
  pair.registration->bend = {rms_m, std::pow(0.5 * rms_m * rms_m, 2), BendKind::kTarget, 12};
  return pair;
}

TEST(JudgePair, ABendCountsTowardsTheDisagreement) {
  EXPECT_EQ(verdict_of(pair_bent(0.03)), Verdict::kConsistent);
  EXPECT_EQ(verdict_of(pair_bent(0.11)), Verdict::kUnverified);
  std::vector<JudgedPair> pairs = {judged(pair_bent(0.4))};
  (void)judge_map(pairs, kRobots, {});
  EXPECT_EQ(pairs[0].verdict.verdict, Verdict::kInconsistent);
  EXPECT_FALSE(pairs[0].verdict.rigid);
  EXPECT_NE(pairs[0].verdict.reason.find("the target is bent"), std::string::npos) << pairs[0].verdict.reason;
  EXPECT_NEAR(*pairs[0].verdict.disagreement_m, std::hypot(0.02, 0.4), 1e-12);
  EXPECT_LT(pairs[0].verdict.evidence.at("displacement").log_ratio, 0.0);
  EXPECT_GT(pairs[0].verdict.log_odds, 0.0);
}

TEST(JudgePair, ConflictThatABendExplainsIsNoDoubt) {
  PairEvidence pair = pair_bent(0.4);
  pair.registered->conflict = {{1000, 300}, {1000, 300}};
  EXPECT_EQ(verdict_of(pair), Verdict::kInconsistent);
  PairEvidence moved = pair_moved(2.0, 0.01);  // a pose far away that conflicts may be a wrong one
  moved.registration->bend = pair.registration->bend;
  moved.registered->conflict = pair.registered->conflict;
  EXPECT_EQ(verdict_of(moved), Verdict::kUnverified);
}

// Two places taken for one, or submaps bent beyond repair: no registration is believed, yet walls stand where the other
// submap saw through.
TEST(JudgePair, FreeSpaceAloneTellsWrongPlaces) {
  PairEvidence pair = pair_moved(0.6, 0.01);
  pair.registration->support_end = pair.registration->support_start;  // fits no better there
  pair.map.conflict = {{1000, 450}, {1000, 350}};
  std::vector<JudgedPair> pairs = {judged(pair)};
  const MapVerdict map = judge_map(pairs, kRobots, {});
  EXPECT_EQ(pairs[0].verdict.verdict, Verdict::kInconsistent);
  EXPECT_NE(pairs[0].verdict.reason.find("40 % of what both saw conflicts"), std::string::npos)
      << pairs[0].verdict.reason;
  EXPECT_TRUE(pairs[0].verdict.without_registration) << "its registration is no constraint";
  EXPECT_GT(pairs[0].verdict.evidence.at("conflict").log_ratio, 0.0);
  EXPECT_FALSE(map.certificate_m) << "free space bounds a disagreement from below only";
  EXPECT_EQ(map.certificate_excludes.size(), 1U);
  PairEvidence failed = pair;
  failed.registration->stop = StopReason::kMaxIterations;
  failed.registered.reset();
  EXPECT_EQ(verdict_of(failed), Verdict::kInconsistent);
  EXPECT_FALSE(judged(failed).verdict.evidence.contains("disagreement")) << "nothing was measured of it";
  EXPECT_EQ(verdict_of(failed, {.tolerance_m = 0.3}), Verdict::kUnverified) << "the margin is less than that";
}

TEST(JudgePair, WhatMovedInBetweenIsNoConflictOfPlaces) {
  PairEvidence pair = pair_moved(0.6, 0.01);
  pair.registration->support_end = pair.registration->support_start;
  pair.map.conflict = {{1000, 180}, {1000, 180}};
  EXPECT_EQ(verdict_of(pair), Verdict::kUnverified);
  pair.map.conflict = {{100, 45}, {100, 45}};  // too little to stand on
  EXPECT_EQ(verdict_of(pair), Verdict::kUnverified);
}

// One aisle may be taken for another, or neighbours bent, so nobody knows the way; but something is in the way.
TEST(JudgePair, ConflictThatAMotionMendsIsNotOfThingsThatMoved) {
  PairEvidence pair = pair_moved(0.6, 0.01);
  pair.registration->searched = true;
  pair.registration->support_end = pair.registration->support_start * 5 / 4;
  pair.agreement.contradicting = 5;
  pair.agreement.contradicting_weight = 3.0;
  pair.map.conflict = {{1000, 150}, {1000, 150}};
  pair.registered->conflict = {{1000, 30}, {1000, 30}};
  EXPECT_EQ(verdict_of(pair), Verdict::kInconsistent);
  EXPECT_NE(judged(pair).verdict.without_registration->find("a motion mends most of it"), std::string::npos);
  PairEvidence stays = pair;
  stays.registered->conflict = {{1000, 80}, {1000, 80}};
  EXPECT_EQ(verdict_of(stays), Verdict::kUnverified);
  PairEvidence unseen = pair;
  unseen.registered->conflict = {{700, 10}, {700, 10}};
  EXPECT_EQ(verdict_of(unseen), Verdict::kUnverified) << "nobody looked where it went";
  PairEvidence lost = pair;
  lost.registered->overlap = 0.3;
  EXPECT_EQ(verdict_of(lost), Verdict::kUnverified);
  PairEvidence no_better = pair;
  no_better.registration->support_end = no_better.registration->support_start;
  EXPECT_EQ(verdict_of(no_better), Verdict::kUnverified);
  no_better.map.conflict = {{1000, 60}, {1000, 60}};  // a share that a disagreement of the tolerance may make
  EXPECT_EQ(verdict_of(no_better), Verdict::kUnverified);
  EXPECT_EQ(verdict_of(no_better, {.tolerance_m = 0.05}), Verdict::kUnverified);
}

// Neighbours that ask for another correction do not say that none is needed.
TEST(JudgePair, WhereAnotherPoseFitsFarBetterTheMapIsWrongWhicheverIsRight) {
  PairEvidence pair = pair_moved(0.6, 0.01);
  pair.registration->searched = true;
  pair.agreement.contradicting = 5;
  pair.agreement.contradicting_weight = 3.0;
  // One such pair among consistent ones may be chance: it takes every fifth of the map.
  const auto among = [&](int consistent_ones) {
    std::vector<JudgedPair> pairs{judged(pair)};
    for (int i = 0; i < consistent_ones; ++i) {
      pairs.push_back(judged(pair_moved(0.02, 0.01, PairKind::kLocal, i + 2)));
    }
    (void)judge_map(pairs, kRobots, {});
    return pairs.front();
  };
  const JudgedPair found = among(3);
  EXPECT_EQ(found.verdict.verdict, Verdict::kInconsistent);
  EXPECT_NE(found.verdict.reason.find("4000 voxels"), std::string::npos) << found.verdict.reason;
  EXPECT_NE(found.verdict.reason.find("5 ask for another correction"), std::string::npos) << found.verdict.reason;
  EXPECT_TRUE(found.verdict.without_registration) << "its registration is no constraint";
  EXPECT_FALSE(found.verdict.disagreement_most_m) << "and bounds nothing";
  EXPECT_TRUE(found.verdict.evidence.at("support").log_ratio);
  EXPECT_EQ(among(8).verdict.verdict, Verdict::kUnverified);
  EXPECT_FALSE(judged(pair_moved(0.6, 0.01)).verdict.evidence.at("support").log_ratio) << "where registration decides";
  pair.registered->conflict = {{1000, 23}, {1000, 23}};
  pair.registration->support_end = 1000000;
  EXPECT_EQ(among(3).verdict.verdict, Verdict::kUnverified) << "the storey above fits, but in free space";
  pair.registered->conflict = pair.map.conflict;
  pair.registration->support_end = pair.registration->support_start * 5 / 4;
  EXPECT_EQ(among(3).verdict.verdict, Verdict::kUnverified) << "too little gained";
  pair = pair_moved(0.08, 0.001);
  pair.registration->searched = true;
  pair.agreement.contradicting_weight = 3.0;
  EXPECT_EQ(among(3).verdict.verdict, Verdict::kUnverified) << "not beyond the tolerance";
}

// Most of those in open car parks are off by a metre or two, and nothing of their own says so.
TEST(JudgePair, WhatOnlyANeighbourSuggestedNeedsOneThatConfirmsIt) {
  PairEvidence pair = pair_moved(0.6, 0.01);
  pair.registration->searched = true;  // no runner-up is known: it was not the wide search that found it
  EXPECT_EQ(verdict_of(pair), Verdict::kUnverified);
  EXPECT_NE(judged(pair).verdict.reason.find("no registration around it confirms"), std::string::npos);
  pair.agreement.agreeing = 1;
  pair.agreement.agreeing_weight = 1.0;
  EXPECT_EQ(verdict_of(pair), Verdict::kInconsistent);
  pair.agreement = {};
  pair.registration->ambiguity = 0.2;
  EXPECT_EQ(verdict_of(pair), Verdict::kInconsistent);
}

TEST(JudgePair, ASmallGainCountsIfFreeSpaceAgrees) {
  PairEvidence pair = pair_moved(0.3, 0.01);
  pair.registration->support_end = pair.registration->support_start * 5 / 4;
  EXPECT_EQ(verdict_of(pair), Verdict::kUnverified);
  pair.map.conflict = {{1000, 80}, {1000, 80}};
  EXPECT_EQ(verdict_of(pair), Verdict::kInconsistent);
  pair.map.conflict = {{1000, 80}, {1000, 80}};
  pair.registered->conflict = {{1000, 45}, {1000, 45}};
  EXPECT_EQ(verdict_of(pair), Verdict::kUnverified) << "more than half is left";
  pair.registered->conflict = {{10000, 20}, {10000, 20}};
  pair.map.conflict = {{10000, 120}, {10000, 120}};
  EXPECT_EQ(verdict_of(pair), Verdict::kInconsistent) << "one in a hundred, by far more than chance";
  pair.grain.voxels_per_cell = 10.0;
  EXPECT_EQ(verdict_of(pair), Verdict::kUnverified) << "of cells that fill ten voxels each it may be chance";
  pair.grain.voxels_per_cell = 1.0;
  pair.registered->conflict = {{5000, 10}, {5000, 10}};
  EXPECT_EQ(verdict_of(pair), Verdict::kUnverified) << "what both know is half gone, too";
  pair.registered->conflict = {{1000, 4}, {1000, 4}};
  pair.map.conflict = {{1000, 12}, {1000, 12}};
  EXPECT_EQ(verdict_of(pair), Verdict::kUnverified) << "a chair less";
  pair.registered->conflict = {{100000, 50}, {100000, 50}};
  pair.map.conflict = {{100000, 200}, {100000, 200}};
  EXPECT_EQ(verdict_of(pair), Verdict::kUnverified) << "one in a thousand moves by itself";
}

// Where few voxels face the way moved, a handful more is chance.
TEST(JudgePair, AGainOfAHandfulIsChance) {
  PairEvidence pair = pair_moved(0.3, 0.01);
  pair.registration->support_start = 60;
  pair.registration->support_end = 100;
  EXPECT_EQ(verdict_of(pair), Verdict::kUnverified);
  EXPECT_NE(judged(pair).verdict.reason.find("agrees no better"), std::string::npos) << judged(pair).verdict.reason;
  pair.registration->support_end = 140;
  EXPECT_EQ(verdict_of(pair), Verdict::kInconsistent);
  pair.registration->support_start = pair.registration->support_end = 0;  // nothing faces it
  EXPECT_EQ(verdict_of(pair), Verdict::kUnverified);
}

// A storey below looks like the one above: planes fit there, but walls then stand where the other submap saw through.
TEST(JudgePair, AMoveThatFreeSpaceSpeaksAgainstHasToFitFarBetter) {
  PairEvidence pair = pair_moved(0.3, 0.01);
  pair.map.conflict = {{1000, 10}, {1000, 10}};
  pair.registered->conflict = {{1000, 12}, {1000, 12}};
  PairEvidence stays = pair;  // the same things conflict here and there, give or take one in ten
  stays.registered->conflict = {{1000, 11}, {1000, 11}};
  stays.registration->support_end = stays.registration->support_start * 2;
  EXPECT_EQ(verdict_of(stays), Verdict::kInconsistent);
  pair.registration->support_end = pair.registration->support_start * 2;
  EXPECT_EQ(verdict_of(pair), Verdict::kUnverified);
  EXPECT_NE(judged(pair).verdict.reason.find("conflicts more there"), std::string::npos) << judged(pair).verdict.reason;
  pair.registration->support_end = pair.registration->support_start * 4;
  EXPECT_EQ(verdict_of(pair), Verdict::kInconsistent);
  pair.registered->conflict = {{1000, 20}, {1000, 20}};
  pair.registration->support_end = pair.registration->support_start * 1000;
  EXPECT_EQ(verdict_of(pair), Verdict::kUnverified) << "the ceiling below a floor fits as well as floors do";
  EXPECT_LT(*judged(pair).verdict.p_inconsistent, 0.2) << "right poses are left for such places, too";
}

// Right poses are seldom left, so having left says something even of a registration that settled in the wrong place.
TEST(JudgePair, ARegistrationThatIsNotBelievedSaysLittleOfTheProbability) {
  PairEvidence pair = pair_moved(0.6, 0.01);
  pair.registered->overlap = 0.3;  // lost
  const PairVerdict doubted = judge_pair(pair, {}, {});
  EXPECT_NEAR(*doubted.log_odds, std::log(400.0 * 0.05 / 0.95), 0.01);
  EXPECT_FALSE(doubted.p_value);
  EXPECT_NEAR(*doubted.log_odds, *doubted.evidence.at("disagreement").log_ratio + std::log(0.05 / 0.95), 1e-12);
  PairEvidence still = pair_moved(0.01, 0.01);
  still.registered->overlap = 0.3;
  const PairVerdict quiet = judge_pair(still, {}, {});
  EXPECT_LT(*quiet.p_inconsistent, 0.05);
  EXPECT_GT(*quiet.p_inconsistent, 0.01);
}

TEST(JudgePair, WhatAnUnobservableDirectionCouldHideForbidsConsistent) {
  PairEvidence pair = pair_moved(0.01, 0.01);
  pair.registration->covariance_centre(0, 0) += 0.5 * 0.5;
  pair.registration->unobservable.emplace_back(Vector6::Unit(0));
  EXPECT_EQ(verdict_of(pair), Verdict::kUnverified);
  EXPECT_NE(judged(pair).verdict.reason.find("nothing in the scene fixes"), std::string::npos);
}

// Noise makes every offset larger than what is there: an interval that forgot it would hardly ever begin low enough.
TEST(JudgePair, TheIntervalOfAnOffsetHoldsTheTruthAsOftenAsItSays) {
  constexpr double kSigma_m = 0.01;
  for (const double truth_m : {0.0, 0.01, 0.02, 0.05}) {
    Rng rng(17, static_cast<std::uint64_t>(1000.0 * truth_m));
    constexpr int kTries = 1000;
    int held = 0;
    for (int k = 0; k < kTries; ++k) {
      PairEvidence pair = pair_moved(0.0, kSigma_m);
      pair.registration->T_target_source =
          Pose3::from_translation(truth_m + kSigma_m * rng.normal(), kSigma_m * rng.normal(), kSigma_m * rng.normal());
      const PairVerdict verdict = judge_pair(pair, kNull, {});
      const auto& [low_m, high_m] = *verdict.offset_interval_m;
      held += low_m <= truth_m && truth_m <= high_m ? 1 : 0;
    }
    EXPECT_GE(held, 920) << truth_m;
  }
}

// Pairs that are off by just the tolerance are the last that must not be discovered.
TEST(JudgePair, ThePValueOfWhatIsAtTheToleranceIsSmallAsSeldomAsItSays) {
  constexpr double kSigma_m = 0.02;
  const JudgeOptions options;
  Rng rng(18, 0);
  constexpr int kTries = 4000;
  int small = 0;
  for (int k = 0; k < kTries; ++k) {
    PairEvidence pair = pair_moved(0.0, kSigma_m);
    pair.registration->T_target_source = Pose3::from_translation(options.tolerance_m + kSigma_m * rng.normal(),
                                                                 kSigma_m * rng.normal(), kSigma_m * rng.normal());
    small += *judge_pair(pair, kNull, options).p_value < 0.01 ? 1 : 0;
  }
  EXPECT_LE(small, 60);  // 1.5 %: 1 % and what chance may add
}

}  // namespace
}  // namespace kilter
