// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/report/worst_pairs.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "kilter/report/summary.h"
#include "testing/results.h"

namespace kilter {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::vector<std::string> lines_of(const Result& result) { return worst_pair_lines(result, false, kSummaryColumns); }

std::string table_of(const Result& result) { return fmt::format("{}\n", fmt::join(lines_of(result), "\n")); }

std::size_t line_with(const Result& result, const std::string& part) {
  const std::vector<std::string> lines = lines_of(result);
  const auto found = std::find_if(lines.begin(), lines.end(),
                                  [&](const std::string& line) { return line.find(part) != std::string::npos; });
  EXPECT_NE(found, lines.end()) << "no line has " << part << " in\n" << table_of(result);
  return static_cast<std::size_t>(found - lines.begin());
}

PairResult& add_inconsistent_pair(Result& result, int source, int target, double offset_m) {
  PairResult& pair = testing::add_measured_pair(result, source, target);
  pair.verdict.verdict = Verdict::kInconsistent;
  pair.verdict.offset_m = offset_m;
  return pair;
}

TEST(WorstPairs, ARowTellsOffsetIntervalRotationAndShift) {
  const std::string text = table_of(testing::small_result());
  EXPECT_THAT(text, HasSubstr("! a/1 <- b/1  global      43 cm [39, 47]     1.7 deg  x+0 y-40 z+15 +?   p 0.97"));
  EXPECT_THAT(text, HasSubstr("  a/1 <- a/2  sequential  2.0 cm [1.0, 3.0]  0.1 deg  x+2.0 y+0.0 z+0.0  p <0.01"));
}

TEST(WorstPairs, TheShiftIsTurnedIntoTheWorld) {
  Result result = testing::small_result();
  const Eigen::Quaterniond quarter_turn(Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitZ()));
  result.submaps[0].T_world_submap = Pose3(quarter_turn, Eigen::Vector3d(5.0, 5.0, 5.0));
  EXPECT_THAT(table_of(result), HasSubstr("x+40 y+0 z+15"));
}

TEST(WorstPairs, NoShiftIsToldWhereNobodyKnowsTheRightOne) {
  Result result = testing::small_result();
  for (PairResult& pair : result.pairs) {
    if (pair.verdict.verdict == Verdict::kInconsistent) pair.verdict.without_registration = "another pose fits better";
  }
  const std::string text = table_of(result);
  EXPECT_THAT(text, HasSubstr("43 cm [39, 47]     1.7 deg  not known "));
  EXPECT_THAT(text, HasSubstr("x+2.0 y+0.0 z+0.0"));
}

TEST(WorstPairs, ARegistrationThatIsNotBelievedTellsNoShiftAndComesLast) {
  Result result = testing::small_result();
  PairResult& doubted = result.pairs[2];
  doubted.verdict = result.pairs[1].verdict;
  doubted.verdict.verdict = Verdict::kUnverified;
  doubted.verdict.offset_m = 3.2;  // the storey above
  doubted.verdict.p_value.reset();
  const std::string text = table_of(result);
  const std::size_t at = line_with(result, "320 cm");
  EXPECT_THAT(lines_of(result)[at], HasSubstr("not known"));
  EXPECT_LT(line_with(result, "2.0 cm [1.0, 3.0]"), at);
}

TEST(WorstPairs, InconsistentPairsComeBeforeLargerOffsetsThatAreNot) {
  Result result = testing::small_result();
  result.pairs[0].verdict.verdict = Verdict::kUnverified;
  result.pairs[0].verdict.offset_m = 9.0;
  const std::string text = table_of(result);
  EXPECT_LT(line_with(result, "! a/1 <- b/1"), line_with(result, "? a/1 <- a/2"));
}
// A slip bends everything behind it, so that other pairs are far worse than the one that shows where it happened.
TEST(WorstPairs, TheSlipThatBendsAllBehindItComesFirst) {
  Result result = testing::result_of({{"a", 9}, {"b", 9}});
  for (int i = 0; i < 8; ++i) {
    add_inconsistent_pair(result, 9 + i, i, 2.0 + i);
    testing::add_measured_pair(result, i + 1, i);
  }
  add_inconsistent_pair(result, 7, 1, 0.6);
  PairResult& slip = add_inconsistent_pair(result, 4, 3, 0.3);
  result.pairs.erase(std::find_if(result.pairs.begin(), result.pairs.end(),
                                  [&](const PairResult& pair) { return pair.id == slip.id; }));
  const std::vector<std::string> lines = lines_of(result);
  ASSERT_EQ(lines.size(), 7U);
  EXPECT_THAT(lines[2], HasSubstr("! a/4 <- a/5  sequential  30 cm"));
  EXPECT_THAT(lines[3], HasSubstr("! a/8 <- b/8  global      900 cm"));
  EXPECT_THAT(lines[6], HasSubstr("! a/2 <- a/8  local       60 cm")) << "at least one of each kind";
}

TEST(WorstPairs, SlipsLeaveRoomForOneOfEachOtherKind) {
  Result result = testing::result_of({{"a", 9}, {"b", 1}});
  for (int i = 0; i < 8; ++i) add_inconsistent_pair(result, i + 1, i, 1.0 + i);
  add_inconsistent_pair(result, 5, 2, 0.2);
  add_inconsistent_pair(result, 9, 0, 0.2);
  std::vector<PairKind> kinds;
  for (const PairResult* pair : worst_pairs(result, 5)) kinds.push_back(pair->kind);
  EXPECT_THAT(kinds, ::testing::ElementsAre(PairKind::kSequential, PairKind::kSequential, PairKind::kSequential,
                                            PairKind::kLocal, PairKind::kGlobal));
}

TEST(WorstPairs, ATurnAboutTheVerticalHasASign) {
  Result result = testing::small_result();
  PairResult& pair = result.pairs[1];
  const auto turned_by = [&](const Eigen::Vector3d& turn_rad) {
    pair.verdict.offset_rad = turn_rad.norm();
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(turn_rad.norm(), turn_rad.normalized()));
    pair.T_target_source_registered = Pose3(turn, Eigen::Vector3d(0.1, 0.0, 0.0)) * pair.T_target_source;
    return table_of(result);
  };
  const double degree = M_PI / 180.0;
  EXPECT_THAT(turned_by({0.0, 0.0, 2.0 * degree}), HasSubstr("  +2.0 deg  "));
  EXPECT_THAT(turned_by({0.3 * degree, 0.0, -2.0 * degree}), HasSubstr("  -2.0 deg  "));
  EXPECT_THAT(turned_by({2.0 * degree, 0.0, 0.0}), HasSubstr("  2.0 deg  ")) << "about a level axis";
  // A target that lies on its side: its y is the world's z.
  result.submaps[0].T_world_submap =
      Pose3(Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitX())), Eigen::Vector3d::Zero());
  EXPECT_THAT(turned_by({0.0, -2.0 * degree, 0.0}), HasSubstr("  -2.0 deg  "));
  EXPECT_THAT(turned_by({0.0, 0.0, 2.0 * degree}), HasSubstr("  2.0 deg  "));
  pair.verdict.without_registration = "another pose fits better";
  EXPECT_THAT(turned_by({0.0, -2.0 * degree, 0.0}), HasSubstr("  2.0 deg  ")) << "which way is not known";
}

TEST(WorstPairs, TheHeadingSaysWhereTheShiftHoldsAndFits) {
  Result result = testing::small_result();
  EXPECT_THAT(lines_of(result)[1], HasSubstr("the middle of what both saw"));
  result.system.state = MapState::kConsistent;
  EXPECT_THAT(lines_of(result)[0], AllOf(HasSubstr("Largest offsets"), Not(HasSubstr("Worst"))));
  for (const std::string& line : lines_of(result)) EXPECT_LE(line.size(), static_cast<std::size_t>(kSummaryColumns));
  result.pairs.clear();
  EXPECT_TRUE(lines_of(result).empty());
}

}  // namespace
}  // namespace kilter
