// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/pipeline/measure_pair.h"

#include <gtest/gtest.h>

#include "kilter/registration/uncertainty.h"
#include "testing/moved_pair.h"

namespace kilter {
namespace {

using testing::pair_moved;

PairResult result_of(PairEvidence evidence) {
  std::vector<JudgedPair> judged = {testing::judged(evidence)};
  (void)judge_map(judged, testing::kRobots, {});
  PairMeasurement measurement;
  measurement.evidence = std::move(evidence);
  return pair_result(measurement, judged[0].verdict, {});
}

TEST(PairResult, ARegistrationThatMendsThePairIsHandedOnAsItIs) {
  const PairEvidence pair = pair_moved(0.4, 0.01);
  const PairResult result = result_of(pair);
  EXPECT_EQ(result.verdict.verdict, Verdict::kInconsistent);
  EXPECT_TRUE(result.trusted);
  EXPECT_EQ(*result.covariance, constraint_covariance(*pair.registration, true, 1.0));
}

TEST(PairResult, ABentPairIsHandedOnWithItsBendInTheCovariance) {
  PairEvidence pair = pair_moved(1.5, 0.01);
  pair.registration->bend = {0.3, 1e-4, BendKind::kSource, 4};
  const PairResult result = result_of(pair);
  EXPECT_EQ(result.verdict.verdict, Verdict::kInconsistent);
  EXPECT_TRUE(result.trusted) << result.verdict.reason;
  EXPECT_GT((*result.covariance)(0, 0), 0.3 * 0.3 / 6.0);
}

TEST(PairResult, TheBendIsInTheCovarianceWhateverTheJudgeSaysOfIt) {
  PairMeasurement measurement;
  measurement.evidence = pair_moved(0.4, 0.01);
  measurement.evidence.registration->bend = {0.3, 1e-4, BendKind::kSource, 4};
  PairVerdict by_gamma;  // which asks for no bend
  by_gamma.verdict = Verdict::kInconsistent;
  const PairResult result = pair_result(measurement, by_gamma, {});
  EXPECT_TRUE(result.trusted);
  EXPECT_GT((*result.covariance)(0, 0), 0.3 * 0.3 / 6.0);
}

TEST(PairResult, ARegistrationThatNobodyBelievesIsNotHandedOn) {
  PairEvidence pair = pair_moved(0.05, 0.01);
  pair.map.conflict = {{1000, 450}, {1000, 450}};
  pair.registered->conflict = {{1000, 450}, {1000, 450}};
  const PairResult result = result_of(pair);
  EXPECT_EQ(result.verdict.verdict, Verdict::kInconsistent) << result.verdict.reason;
  ASSERT_TRUE(result.verdict.without_registration);
  EXPECT_FALSE(result.trusted);
}

TEST(PairResult, AnUnverifiedPairIsNotHandedOn) {
  PairEvidence pair = pair_moved(0.09, 0.03);
  const PairResult result = result_of(pair);
  EXPECT_EQ(result.verdict.verdict, Verdict::kUnverified);
  EXPECT_FALSE(result.trusted);
}

}  // namespace
}  // namespace kilter
