// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "kilter/verification/judge.h"
#include "testing/moved_pair.h"

namespace kilter {
namespace {

using testing::kNull;
using testing::pair_moved;

MapNull null_of(const std::vector<PairEvidence>& pairs) {
  std::vector<const PairEvidence*> all;
  for (const PairEvidence& pair : pairs) all.push_back(&pair);
  return estimate_null(all);
}

TEST(JudgePairByGamma, FollowsThePapersTestAndVerification) {
  const auto verdict_at = [](double gamma, double theta, double offset_m) {
    PairEvidence pair = pair_moved(offset_m, 0.01);
    pair.map.score.emplace().log10_gamma = gamma;
    pair.registered->score.emplace().log10_gamma = theta;
    return judge_pair_by_gamma(pair, kNull).verdict;
  };
  EXPECT_EQ(verdict_at(2.0, 2.1, 0.02), Verdict::kConsistent);
  EXPECT_EQ(verdict_at(1.2, 2.0, 0.5), Verdict::kInconsistent);
  EXPECT_EQ(verdict_at(1.2, 1.3, 0.5), Verdict::kUnverified);  // "rejected": Theta hardly differs
  EXPECT_EQ(verdict_at(1.2, 2.0, 0.05), Verdict::kUnverified);
  PairEvidence apart = pair_moved(0.0, 0.01);
  apart.overlaps = false;
  EXPECT_EQ(judge_pair_by_gamma(apart, kNull).verdict, Verdict::kUnverified);
}

TEST(JudgePairByGamma, DecidesNothingWhereRegistrationFailed) {
  for (const double gamma : {2.0, 1.2}) {
    PairEvidence failed = pair_moved(0.0, 0.01);
    failed.map.score.emplace().log10_gamma = gamma;
    PairEvidence lost = failed;
    failed.registration->stop = StopReason::kTooFewMatches;
    failed.registered.reset();
    const PairVerdict verdict = judge_pair_by_gamma(failed, kNull);
    EXPECT_EQ(verdict.verdict, Verdict::kUnverified);
    EXPECT_EQ(verdict.reason.find("registration failed: too few matches; log10 Gamma"), 0U) << verdict.reason;
    EXPECT_FALSE(verdict.offset_m);
    EXPECT_EQ(verdict.evidence.at("log10_gamma").value, gamma);
    lost.registered->score.reset();  // converged below the gate
    EXPECT_EQ(judge_pair_by_gamma(lost, kNull).verdict, Verdict::kUnverified);
    lost.registration.reset();
    EXPECT_EQ(judge_pair_by_gamma(lost, kNull).verdict, Verdict::kUnverified);
  }
}

// Gamma speaks of the map's pose: what a registration found elsewhere, or may have mistaken, is not handed on with it.
TEST(JudgePairByGamma, HandsOnNoRegistrationThatItSaysNothingOf) {
  const auto judged = [](double gamma, double offset_m, const auto& change) {
    PairEvidence pair = pair_moved(offset_m, 0.01);
    pair.map.score.emplace().log10_gamma = gamma;
    pair.registered->score.emplace().log10_gamma = 2.1;
    change(pair);
    return judge_pair_by_gamma(pair, kNull);
  };
  const auto nothing = [](PairEvidence&) {};
  EXPECT_FALSE(judged(2.0, 0.02, nothing).without_registration);
  EXPECT_FALSE(judged(1.2, 0.5, nothing).without_registration);
  const PairVerdict elsewhere = judged(2.0, 4.0, nothing);
  EXPECT_EQ(elsewhere.verdict, Verdict::kConsistent);
  EXPECT_TRUE(elsewhere.without_registration);
  const auto ambiguous = [](PairEvidence& pair) {
    pair.registration->searched = true;
    pair.registration->ambiguity = 0.95;
  };
  const PairVerdict rival = judged(1.2, 0.5, ambiguous);
  EXPECT_EQ(rival.verdict, Verdict::kInconsistent);
  EXPECT_TRUE(rival.without_registration);
  const auto contradicted = [](PairEvidence& pair) {
    pair.registration->searched = true;
    pair.agreement.contradicting = 5;
    pair.agreement.contradicting_weight = 5.0;
  };
  EXPECT_TRUE(judged(2.0, 0.02, contradicted).without_registration);
}

TEST(EstimateNull, OfNothingIsNotHeldAgainstAnything) {
  PairEvidence failed = pair_moved(0.0, 0.01);
  failed.map.score.emplace().log10_gamma = 2.3;
  failed.registration->stop = StopReason::kTooFewMatches;
  failed.registered.reset();
  const PairEvidence* const only = &failed;
  const PairVerdict verdict = judge_pair(failed, estimate_null(std::vector{only}), {});
  EXPECT_EQ(verdict.evidence.at("log10_gamma").value, 2.3);
  EXPECT_FALSE(verdict.evidence.at("log10_gamma").null) << "0 is a value";
  ASSERT_TRUE(verdict.evidence.at("conflict").value);
  EXPECT_FALSE(verdict.evidence.at("conflict").null);
}

TEST(EstimateNull, SurvivesAFifthOfBadSequentialPairs) {
  std::vector<PairEvidence> pairs;
  for (int i = 0; i < 20; ++i) {
    PairEvidence pair = pair_moved(0.01, 0.01, PairKind::kSequential, i + 1);
    if (i % 5 == 0) pair.registered->conflict = {{1000, 500}, {1000, 500}};
    pairs.push_back(pair);
  }
  EXPECT_NEAR(null_of(pairs).conflict, 0.02, 1e-12);
}

// One pair, or two, are in line with themselves, however far apart.
TEST(JudgePairByGamma, NeedsOthersToCompareWith) {
  std::vector<PairEvidence> pairs;
  for (int i = 1; i <= 3; ++i) {
    PairEvidence pair = pair_moved(i == 2 ? 0.8 : 0.01, 0.01, PairKind::kGlobal, i);
    pair.map.score.emplace().log10_gamma = i == 2 ? 1.0 : 2.0 + 0.01 * i;
    pair.registered->score.emplace().log10_gamma = 2.1;
    pairs.push_back(pair);
    const MapNull null = null_of(pairs);
    EXPECT_EQ(null.pairs, pairs.size());
    const PairVerdict first = judge_pair_by_gamma(pairs.front(), null);
    EXPECT_EQ(first.verdict, i < 3 ? Verdict::kUnverified : Verdict::kConsistent);
    EXPECT_TRUE(first.offset_m);
    EXPECT_EQ(first.reason.find("too few to compare it with") != std::string::npos, i < 3) << first.reason;
  }
  EXPECT_EQ(judge_pair_by_gamma(pairs[1], null_of(pairs)).verdict, Verdict::kInconsistent);
}

// Two storeys of one plan, one laid on the other: nothing else in the map says that 40 % of conflict is much.
TEST(EstimateNull, OfFewPairsTakesNoMoreConflictForTypicalThanOtherMapsHave) {
  PairEvidence storeys = pair_moved(0.01, 0.01);
  storeys.map.conflict = storeys.registered->conflict = {{1000, 400}, {1000, 400}};
  std::vector<PairEvidence> pairs = {storeys};
  EXPECT_NE(judge_pair(storeys, null_of(pairs), {}).verdict, Verdict::kConsistent);
  for (int i = 2; i <= 8; ++i) pairs.push_back(pair_moved(0.01, 0.01, PairKind::kGlobal, i));
  EXPECT_NEAR(null_of(pairs).conflict, 0.02, 1e-12);
  EXPECT_NE(judge_pair(storeys, null_of(pairs), {}).verdict, Verdict::kConsistent);
}

}  // namespace
}  // namespace kilter
