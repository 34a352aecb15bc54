// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>

#include "kilter/verification/judge.h"
#include "testing/moved_pair.h"

namespace kilter {
namespace {

using testing::kRobots;

// A pair of robots a and b, or of a alone, that is this far apart, give or take.
JudgedPair pair_apart(double apart_m, double sigma_m, PairKind kind = PairKind::kGlobal, int source = 1) {
  return testing::judged(testing::pair_moved(apart_m, sigma_m, kind, source));
}

TEST(JudgeMap, OneBadPairMakesTheMapInconsistent) {
  std::vector<JudgedPair> pairs;
  for (int i = 1; i < 20; ++i) pairs.push_back(pair_apart(0.02, 0.01, PairKind::kGlobal, i));
  pairs.push_back(pair_apart(0.40, 0.02, PairKind::kGlobal, 20));
  const MapVerdict map = judge_map(pairs, kRobots, {});
  EXPECT_EQ(map.state, MapState::kInconsistent);
  EXPECT_EQ(map.inconsistent, 1U);
  EXPECT_EQ(map.tested, 20U);
  EXPECT_GT(*map.certificate_m, 0.4);
  ASSERT_TRUE(map.certificate_of);
  const auto widest = std::find_if(pairs.begin(), pairs.end(), [&](const JudgedPair& pair) {
    return pair.verdict.disagreement_most_m == map.certificate_m;
  });
  ASSERT_NE(widest, pairs.end());
  EXPECT_EQ(*map.certificate_of, widest->id);
  EXPECT_LT(map.log_probability.global.at("a,b"), -20.0);
}

TEST(JudgeMap, EstablishesNothingThatIsLikelierNotSo) {
  std::vector<JudgedPair> pairs = {pair_apart(0.40, 0.02)};
  pairs[0].verdict.log_odds = -0.1;
  EXPECT_EQ(judge_map(pairs, kRobots, {}).state, MapState::kUndetermined);
  EXPECT_EQ(pairs[0].verdict.verdict, Verdict::kUnverified);
}

TEST(JudgeMap, RobotsThatNeverMeetLeaveItUndetermined) {
  std::vector<JudgedPair> pairs = {pair_apart(0.01, 0.01, PairKind::kSequential)};
  const MapVerdict map = judge_map(pairs, kRobots, {});
  EXPECT_EQ(map.state, MapState::kUndetermined);
  EXPECT_NE(map.reason.find("a and b never meet"), std::string::npos);
  EXPECT_EQ(map.decided.global.at("a,b"), std::nullopt) << "no share of nothing";
  EXPECT_EQ(*map.decided.sequential, 1.0);
  EXPECT_FALSE(map.decided.local.has_value());
}

TEST(JudgeMap, NamesRobotsWholeWhoseNamesHoldCommas) {
  const std::vector<std::string> robots = {"north, hall", "south, hall"};
  std::vector<JudgedPair> pairs = {pair_apart(0.01, 0.01, PairKind::kSequential)};
  const MapVerdict map = judge_map(pairs, robots, {});
  EXPECT_NE(map.reason.find("robots north, hall and south, hall never meet"), std::string::npos) << map.reason;
}

TEST(JudgeMap, CertifiesNothingOfRobotsThatNothingTiesTogether) {
  const std::vector<std::string> three = {"a", "b", "c"};
  std::vector<JudgedPair> pairs = {pair_apart(0.01, 0.01, PairKind::kSequential), pair_apart(0.01, 0.01)};
  EXPECT_FALSE(judge_map(pairs, three, {}).certificate_m.has_value()) << "c may be anywhere";
  pairs.push_back(pair_apart(0.05, 0.2, PairKind::kGlobal, 2));
  pairs.back().source_robot = 2;
  EXPECT_FALSE(judge_map(pairs, three, {}).certificate_m.has_value()) << "undecided, it ties nothing";
  pairs.back() = pair_apart(0.02, 0.01, PairKind::kGlobal, 2);
  pairs.back().source_robot = 2;
  EXPECT_TRUE(judge_map(pairs, three, {}).certificate_m.has_value()) << "through a or b";
}

TEST(JudgeMap, RobotsThatMeetButShowTooLittleAreNotSaidNeverToMeet) {
  std::vector<JudgedPair> pairs = {pair_apart(0.01, 0.01, PairKind::kSequential),
                                   pair_apart(0.05, 0.2, PairKind::kGlobal, 2)};
  pairs[1].waited_for = false;
  const MapVerdict map = judge_map(pairs, kRobots, {});
  EXPECT_EQ(map.state, MapState::kUndetermined);
  EXPECT_EQ(map.reason, "robots a and b never show enough of the same place");
}

// Free space says that the places of two robots differ, and nothing bounds by how much.
TEST(JudgeMap, CertifiesNothingOfRobotsThatOnlyAPairWithoutABoundTies) {
  std::vector<JudgedPair> pairs = {pair_apart(0.01, 0.01, PairKind::kSequential),
                                   pair_apart(0.4, 0.01, PairKind::kGlobal, 2)};
  EXPECT_TRUE(judge_map(pairs, kRobots, {}).certificate_m);
  pairs[1].verdict.without_registration = "free space";
  pairs[1].verdict.disagreement_most_m.reset();
  const MapVerdict map = judge_map(pairs, kRobots, {});
  EXPECT_EQ(map.state, MapState::kInconsistent);
  EXPECT_FALSE(map.certificate_m);
  EXPECT_EQ(map.certificate_excludes.size(), 1U);
}

// Two submaps whose pairs stay undecided may lie anywhere, though robots are tied by others.
TEST(JudgeMap, CertifiesNothingOfSubmapsThatNothingTies) {
  std::vector<JudgedPair> pairs = {pair_apart(0.01, 0.01, PairKind::kSequential),
                                   pair_apart(0.03, 0.01, PairKind::kGlobal, 2),
                                   pair_apart(0.05, 0.2, PairKind::kLocal, 3)};
  const MapVerdict map = judge_map(pairs, kRobots, {});
  EXPECT_EQ(map.unverified, 1U);
  EXPECT_FALSE(map.certificate_m);
  EXPECT_EQ(map.untied, 1U);
}

// An offset just above the tolerance, and a bend just below it.
TEST(JudgeMap, SaysThatOffsetAndBendAreAboveTheToleranceTogether) {
  PairEvidence pair = testing::pair_moved(0.105, 0.01);
  pair.registration->bend.rms_m = 0.095;
  pair.registration->bend.kind = BendKind::kSource;
  std::vector<JudgedPair> pairs = {testing::judged(pair)};
  (void)judge_map(pairs, kRobots, {});
  ASSERT_EQ(pairs[0].verdict.verdict, Verdict::kInconsistent);
  EXPECT_NE(pairs[0].verdict.reason.find("and with what no rigid motion mends 14.2 cm apart: above"), std::string::npos)
      << pairs[0].verdict.reason;
}

TEST(JudgeMap, EnoughDecidedPairsMakeItConsistent) {
  std::vector<JudgedPair> pairs = {pair_apart(0.01, 0.01, PairKind::kSequential),
                                   pair_apart(0.03, 0.01, PairKind::kGlobal, 2)};
  const MapVerdict map = judge_map(pairs, kRobots, {});
  EXPECT_EQ(map.state, MapState::kConsistent);
  EXPECT_LT(*map.certificate_m, 0.1);
  EXPECT_GT(*map.log_probability.total, -0.2);
}

TEST(JudgeMap, TooManyUndecidedPairsLeaveItUndetermined) {
  std::vector<JudgedPair> pairs = {pair_apart(0.01, 0.01), pair_apart(0.05, 0.2, PairKind::kGlobal, 2),
                                   pair_apart(0.05, 0.2, PairKind::kGlobal, 3)};
  const MapVerdict map = judge_map(pairs, kRobots, {});
  EXPECT_EQ(map.state, MapState::kUndetermined);
  EXPECT_EQ(map.certificate_excludes.size(), 2U);
  std::vector<JudgedPair> undecided = {pair_apart(0.05, 0.2, PairKind::kGlobal, 2)};
  JudgeOptions nothing_asked;
  nothing_asked.min_decided = 0.0;
  EXPECT_EQ(judge_map(undecided, kRobots, nothing_asked).state, MapState::kUndetermined);
}

// Storeys above each other: floors and the ceilings below them match, and were never seen from one side.
TEST(JudgeMap, DoesNotWaitForPairsThatMayShowDifferentPlaces) {
  std::vector<JudgedPair> pairs = {pair_apart(0.01, 0.01), pair_apart(0.05, 0.2, PairKind::kGlobal, 2),
                                   pair_apart(0.05, 0.2, PairKind::kGlobal, 3)};
  pairs[1].overlaps = pairs[2].overlaps = false;
  MapVerdict map = judge_map(pairs, kRobots, {});
  EXPECT_EQ(map.state, MapState::kConsistent);
  EXPECT_EQ(map.unverified, 2U);
  EXPECT_TRUE(map.certificate_excludes.empty());
  pairs = {pair_apart(0.4, 0.01), pair_apart(0.05, 0.2, PairKind::kGlobal, 2)};
  pairs[0].overlaps = false;  // decided by what little there is
  map = judge_map(pairs, kRobots, {});
  EXPECT_EQ(map.state, MapState::kInconsistent);
  EXPECT_EQ(map.decided.global.at("a,b"), 0.5);
}

TEST(JudgeMap, NamesWhatItDoesNotWaitForAmongWhatTheCertificateExcludes) {
  std::vector<JudgedPair> pairs = {pair_apart(0.01, 0.01), pair_apart(0.05, 0.2, PairKind::kGlobal, 2),
                                   pair_apart(0.05, 0.2, PairKind::kGlobal, 3)};
  pairs[1].waited_for = pairs[2].waited_for = false;
  const MapVerdict map = judge_map(pairs, kRobots, {});
  EXPECT_EQ(map.state, MapState::kConsistent);
  EXPECT_EQ(map.certificate_excludes.size(), 2U);
}

TEST(JudgeMap, NothingToCompareIsUndetermined) {
  std::vector<JudgedPair> none;
  const std::vector<std::string> one = {"a"};
  const MapVerdict map = judge_map(none, one, {});
  EXPECT_EQ(map.state, MapState::kUndetermined);
  EXPECT_FALSE(map.log_probability.total.has_value());
  EXPECT_FALSE(map.certificate_m.has_value());
}

}  // namespace
}  // namespace kilter
