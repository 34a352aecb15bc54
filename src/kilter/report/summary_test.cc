// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/report/summary.h"

#include <algorithm>
#include <sstream>

#include <gmock/gmock.h>

#include "kilter/report/text_lines.h"
#include "testing/results.h"

namespace kilter {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST(Summary, SaysWhatSourcesWere) {
  SummaryOptions options;
  options.sources = {"GLIM dump, 3 submaps, 1 robot", "mission, 2 scans, 1 robot"};
  EXPECT_NE(summary(testing::small_result(), options).find("Sources     GLIM dump, 3 submaps, 1 robot; mission"),
            std::string::npos);
}

TEST(Summary, TheVerdictComesFirst) {
  Result result = testing::small_result();
  EXPECT_THAT(summary(result), StartsWith("INCONSISTENT: 1 of 3 pairs"));
  result.system.state = MapState::kConsistent;
  EXPECT_THAT(summary(result), StartsWith("CONSISTENT: "));
  result.system.state = MapState::kUndetermined;
  EXPECT_THAT(summary(result), StartsWith("UNDETERMINED: "));
}

TEST(Summary, FitsATerminalHoweverLargeTheMission) {
  const std::string long_name(90, 'x');
  std::vector<testing::RobotOf> robots;
  for (int i = 0; i < 30; ++i) robots.push_back({long_name + std::to_string(i), 3});
  Result result = testing::result_of(robots);
  for (int source = 1; source < 60; ++source) {
    PairResult& pair = testing::add_measured_pair(result, source, source - 1);
    pair.verdict.offset_m = 1234.0;
    pair.verdict.offset_interval_m = {{1200.0, 1300.0}};
    pair.verdict.offset_vector_m = Eigen::Vector3d(-1234.0, 1234.0, -1234.0);
    PairResult& thin = testing::add_empty_pair(result, source + 20, source - 1);
    thin.verdict.reason = std::string(static_cast<std::size_t>(source % 7), 'x') + std::string(200, 'y');
    result.system.certificate_excludes.push_back(thin.id);
  }
  PairResult& local = testing::add_measured_pair(result, 2, 0);
  local.verdict.verdict = Verdict::kInconsistent;
  local.verdict.rigid = false;
  result.system.inconsistent = 1;
  result.candidates = result.too_little_overlap = 1000000;
  result.system.certificate_m = 1234.5;
  result.system.reason = "because " + std::string(50, 'z') + " and " + std::string(300, 'z');
  SummaryOptions options;
  options.output_folder = std::string(200, 'o');
  options.sources.assign(9, std::string(60, 's'));
  for (const MapState state : {MapState::kConsistent, MapState::kInconsistent, MapState::kUndetermined}) {
    result.system.state = state;
    const std::vector<std::string> lines = lines_of(summary(result, options));
    EXPECT_LE(lines.size(), static_cast<std::size_t>(kSummaryLines)) << summary(result, options);
    for (const std::string& line : lines)
      EXPECT_LE(columns_of(line), static_cast<std::size_t>(kSummaryColumns)) << line;
  }
}

TEST(Summary, AdvisesTheOptimiserOnlyIfThereIsAConstraintToGiveIt) {
  Result result = testing::small_result();
  const auto disagreeing = [&]() -> PairResult& {
    return *std::find_if(result.pairs.begin(), result.pairs.end(),
                         [](const PairResult& pair) { return pair.verdict.verdict == Verdict::kInconsistent; });
  };
  disagreeing().trusted = true;
  EXPECT_THAT(summary(result), HasSubstr("Next        give kilter-out/constraints.g2o to the optimiser"));
  result.system.inconsistent = 3;
  EXPECT_THAT(summary(result), HasSubstr("(constraints for 1 of the 3)"));
  disagreeing().trusted = false;
  EXPECT_THAT(summary(result), HasSubstr("Next        no correction of a pair that disagrees can be believed"));
  SummaryOptions odd;
  odd.odd = "millimetres of robot a";
  EXPECT_THAT(summary(result, odd), HasSubstr("Next        see to the input first (millimetres of robot a)"));
}

TEST(Summary, TheAdviceNamesThePosesThatItNeedsAgain) {
  Result result = testing::small_result();
  for (PairResult& pair : result.pairs) pair.trusted = true;
  SummaryOptions options;
  EXPECT_THAT(summary(result, options), Not(HasSubstr("--poses")));
  options.poses = "better";
  EXPECT_THAT(summary(result, options), HasSubstr("--poses better"));
  // What is there to be typed is whole, or called what the help calls it.
  options.output_folder = std::string(70, 'o');
  EXPECT_THAT(summary(result, options), HasSubstr(" " + options.output_folder + " --poses better"));
  options.output_folder += 'o';
  EXPECT_THAT(summary(result, options), HasSubstr("--cuts OUT --poses better"));
  options.output_folder = "of(monday)";
  EXPECT_THAT(summary(result, options), HasSubstr("--cuts 'of(monday)' --poses better"));
  options.output_folder = "of monday";  // a line might break inside
  EXPECT_THAT(summary(result, options), AllOf(HasSubstr("--cuts OUT --poses better"), HasSubstr("give of monday/")));
}

TEST(Summary, SaysOfHowManySubmapsNothingIsCertified) {
  Result result = testing::small_result();
  result.system.certificate_m.reset();
  result.system.untied = 1;
  EXPECT_THAT(summary(result), AllOf(HasSubstr("no decided pair bounds"), HasSubstr("1 of 3 submaps lies")));
}

TEST(Summary, GatesThatLeaveNoPairAreNamed) {
  Result result = testing::small_result();
  result.pairs.clear();
  result.system.state = MapState::kUndetermined;
  result.too_little_overlap = 0;
  EXPECT_THAT(summary(result), HasSubstr("where it shows a place twice"));
  result.too_little_overlap = 7;
  EXPECT_THAT(summary(result), HasSubstr("7 pairs are near enough to show the same place"));
  result.too_little_overlap = 1;
  EXPECT_THAT(summary(result), HasSubstr("1 pair is near enough to show the same place, but shares less"));
}

TEST(Summary, ReasonsBeyondTheThirdAreCounted) {
  Result result = testing::small_result();
  const PairResult like = result.pairs[0];
  const auto with = [&](const std::vector<std::string>& reasons) {
    result.pairs.clear();
    for (const std::string& reason : reasons) {
      result.pairs.push_back(like);
      result.pairs.back().verdict.verdict = Verdict::kUnverified;
      result.pairs.back().verdict.reason = reason;
    }
    return summary(result);
  };
  EXPECT_THAT(with({"too bent", "too far", "too near"}), Not(HasSubstr("for other reasons")));
  EXPECT_THAT(with({"too bent", "too far", "too near", "too dark", "too loud"}), HasSubstr("3 x for other reasons"));
}

TEST(Summary, ThePapersTestKnowsNoTolerance) {
  Result result = testing::small_result();
  result.system.state = MapState::kConsistent;
  SummaryOptions options;
  EXPECT_THAT(summary(result, options), HasSubstr("nothing to mend above 0.10 m"));
  options.papers_test = true;
  EXPECT_THAT(summary(result, options), Not(HasSubstr("nothing to mend")));
}

TEST(Summary, CountsPairsByKind) {
  const std::string text = summary(testing::small_result());
  EXPECT_THAT(text, HasSubstr("  sequential       1            1             0           0\n"));
  EXPECT_THAT(text, HasSubstr("  global           2            0             1           1\n"));
  EXPECT_THAT(text, HasSubstr("Unverified  1 x too little overlap\n"));
  EXPECT_THAT(text, HasSubstr("  1 more pair of submaps near each other shares too little to be tested\n"));
  Result more = testing::small_result();
  more.too_little_overlap = 8;
  EXPECT_THAT(summary(more), HasSubstr("  8 more pairs of submaps near each other share too little to be tested\n"));
}

TEST(Summary, ReasonsThatDifferInNumbersAreCountedTogether) {
  Result result = testing::result_of({{"a", 5}});
  testing::add_empty_pair(result, 1, 0).verdict.reason = "offset 3.1 cm (2.0 to 4.2 cm): too uncertain";
  testing::add_empty_pair(result, 4, 0).verdict.reason =
      "offset 31 cm (20 to 42 cm), but the pair agrees no better there";
  testing::add_empty_pair(result, 2, 0).verdict.reason = "offset 13.1 cm (9.0 to 24.2 cm): too uncertain";
  testing::add_empty_pair(result, 3, 0).verdict.reason = "too little overlap: 7 % match; moved by 1.5 m, more would";
  const std::string text = summary(result);
  EXPECT_THAT(text, HasSubstr("Unverified  2 x too uncertain to be told from the tolerance\n            1 x "));
  EXPECT_THAT(text, HasSubstr("  1 x too little overlap\n"));
  EXPECT_THAT(text, HasSubstr("  1 x it agrees no better where registration puts it\n"));
  Result by_gamma = testing::result_of({{"a", 5}});
  testing::add_empty_pair(by_gamma, 4, 3).verdict.reason = "log10 Gamma 1.20 is low for this map (from 1.51)";
  EXPECT_THAT(summary(by_gamma), HasSubstr("Unverified  1 x log10 Gamma .. is low for this map (from ..)\n"));
}

TEST(Summary, SaysWhatTheCertificateLeavesOut) {
  Result result = testing::small_result();
  EXPECT_THAT(summary(result), HasSubstr("Certified   consistent to 0.22 m at 95 %; says nothing about 1 of"));
  const auto said_of = [&](double certificate_m) {
    result.system.certificate_m = certificate_m;
    return summary(result);
  };
  EXPECT_THAT(said_of(0.0036), HasSubstr("consistent to 0.01 m at 95 %")) << "never less than it is";
  EXPECT_THAT(said_of(0.2204), HasSubstr("consistent to 0.23 m at 95 %"));
  EXPECT_THAT(said_of(0.29), HasSubstr("consistent to 0.29 m at 95 %"));
  EXPECT_THAT(said_of(0.0), HasSubstr("consistent to 0.01 m at 95 %")) << "nor -0.00";
  result.system.certificate_m.reset();
  EXPECT_THAT(summary(result), HasSubstr("Certified   none"));
}

TEST(Summary, SaysHowManyOfTheExcludedAreKnownToBeWrong) {
  Result result = testing::small_result();
  for (const PairResult& pair : result.pairs) {
    if (pair.verdict.verdict == Verdict::kInconsistent) result.system.certificate_excludes.push_back(pair.id);
  }
  EXPECT_THAT(summary(result),
              HasSubstr("says nothing about 2 of the pairs that overlap, 1 of them\n            inconsistent (a/2"));
}

// Poses of whole submaps are no cure for what is bent inside.
TEST(Summary, PointsToWhereBendsComeFrom) {
  Result result = testing::small_result();
  result.system.state = MapState::kInconsistent;
  result.system.inconsistent = 1;
  EXPECT_THAT(summary(result), HasSubstr("Next        give "));
  for (PairResult& pair : result.pairs) pair.verdict.rigid = pair.verdict.verdict != Verdict::kInconsistent;
  EXPECT_THAT(summary(result), HasSubstr("Next        1 of the 1 are bent inside: see to stamps, de-skewing, T_body"));
  result.system.inconsistent = 4;
  EXPECT_THAT(summary(result), HasSubstr("Next        give "));
}

TEST(Summary, AConsistentMapStillNamesWhatLikelyIsNot) {
  Result result = testing::small_result();
  result.system.state = MapState::kConsistent;
  for (PairResult& pair : result.pairs) pair.verdict.verdict = Verdict::kConsistent;
  EXPECT_THAT(summary(result), HasSubstr("Next        nothing to mend"));
  result.pairs[0].verdict.verdict = Verdict::kUnverified;
  result.pairs[0].verdict.p_inconsistent = 0.9;
  EXPECT_THAT(summary(result), HasSubstr("Next        1 undecided pair likelier disagrees than not: look at "));
}

TEST(Summary, NamesRobotsThatNeverMeet) {
  Result result = testing::result_of({{"a", 2}, {"b", 1}, {"c", 1}});
  testing::add_measured_pair(result, 1, 0);
  testing::add_measured_pair(result, 2, 0);
  const std::string text = summary(result);
  EXPECT_THAT(text, HasSubstr("Never meet  a and c; b and c\n"));
  EXPECT_THAT(text, HasSubstr("Next        send robots that never meet"));
}

TEST(Summary, RangesThatLeaveNothingOfARobotAreTheFirstThingToMend) {
  Result result = testing::result_of({{"a", 2}, {"b", 2}, {"c", 1}});
  result.system.state = MapState::kUndetermined;
  testing::add_measured_pair(result, 1, 0);
  result.submaps[1].occupied = 0;
  EXPECT_THAT(summary(result), HasSubstr("Next        send robots that never meet")) << "a/1 has a surface";
  for (const std::size_t i : {2U, 3U, 4U}) result.submaps[i].occupied = 0;
  EXPECT_THAT(summary(result),
              HasSubstr("Next        widen min_range and max_range: they leave no surface to any submap of b, c"));
}

TEST(Summary, SaysSoWhenThereWasNothingToCompare) {
  const Result result = testing::result_of({{"a", 1}});
  EXPECT_THAT(summary(result), Not(HasSubstr("Pairs")));
  EXPECT_THAT(summary(result), HasSubstr("Next        one submap has nothing to be compared with: shorter submaps"));
  EXPECT_THAT(summary(testing::result_of({{"a", 2}})),
              HasSubstr("Next        a map can only be compared with itself where"));
}

TEST(Summary, ColoursOnlyWhenAskedAndOnlyTheVerdict) {
  const Result result = testing::small_result();
  EXPECT_THAT(summary(result), Not(HasSubstr("\x1b")));
  SummaryOptions options;
  options.colour = true;
  EXPECT_THAT(summary(result, options), StartsWith("\x1b[1;31mINCONSISTENT\x1b[0m: 1 of 3"));
}

TEST(Summary, HoldsNoBytesThatSteerATerminal) {
  Result result = testing::result_of({{"a\x1b[2J", 2}});
  testing::add_measured_pair(result, 1, 0);
  EXPECT_THAT(summary(result), Not(HasSubstr("\x1b")));
}

}  // namespace
}  // namespace kilter
