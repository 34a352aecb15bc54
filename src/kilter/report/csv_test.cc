// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <limits>
#include <sstream>
#include <vector>

#include <gtest/gtest.h>

#include "kilter/report/csv_cell.h"
#include "kilter/report/matrix_csv.h"
#include "kilter/report/pairs_csv.h"
#include "testing/results.h"

namespace kilter {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// Cells of a line without quotes.
std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',') {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  return cells;
}

TEST(CsvCell, TextIsQuotedOnlyWhereItMustBe) {
  EXPECT_EQ(csv_cell("a/1"), "a/1");
  EXPECT_EQ(csv_cell("a,b"), "\"a,b\"");
  EXPECT_EQ(csv_cell("say \"no\""), "\"say \"\"no\"\"\"");
  EXPECT_EQ(csv_cell("two\nlines"), "\"two\nlines\"");
}

TEST(CsvCell, TextThatASpreadsheetWouldRunIsDisarmed) {
  EXPECT_EQ(csv_cell("=1+1"), "'=1+1");
  EXPECT_EQ(csv_cell("@SUM(A1)"), "'@SUM(A1)");
  EXPECT_EQ(csv_cell("-2,3"), "\"'-2,3\"");
  EXPECT_EQ(csv_cell("+49/1"), "'+49/1");
}

TEST(CsvCell, NumbersKeepTheirSignAndAbsentOnesAreEmpty) {
  EXPECT_EQ(csv_cell(-0.1), "-0.1");
  EXPECT_EQ(csv_cell(std::optional<double>()), "");
  EXPECT_EQ(csv_cell(std::numeric_limits<double>::infinity()), "");
  EXPECT_EQ(csv_cell(std::nan("")), "");
}

TEST(MatrixCsv, RowIsSourceAndColumnIsTarget) {
  const Result result = testing::result_of({{"a", 2}, {"b", 1}});
  const std::map<PairId, double> cells = {{{SubmapId{1}, SubmapId{0}}, 0.1}, {{SubmapId{2}, SubmapId{1}}, -7.5}};
  EXPECT_EQ(matrix_csv(result, cells), ",a/1,a/2,b/1\na/1,,,\na/2,0.1,,\nb/1,,-7.5,\n");
}

TEST(MatrixCsv, IsSquareForAnyNumberOfSubmaps) {
  EXPECT_EQ(matrix_csv(Result(), {}), "\n");
  const std::vector<std::string> lines = lines_of(matrix_csv(testing::result_of({{"a", 40}}), {}));
  ASSERT_EQ(lines.size(), 41U);
  for (const std::string& line : lines) EXPECT_EQ(cells_of(line).size(), 41U);
}

TEST(PairsCsv, EveryRowHasACellForEveryColumn) {
  const std::vector<std::string> lines = lines_of(pairs_csv(testing::small_result()));
  ASSERT_EQ(lines.size(), 4U);
  const std::size_t columns = cells_of(lines[0]).size();
  for (const std::string& line : lines) EXPECT_EQ(cells_of(line).size(), columns) << line;
}

TEST(PairsCsv, ColumnsAreTheSameWhateverWasMeasured) {
  Result bare = testing::small_result();
  for (PairResult& pair : bare.pairs) pair.verdict.evidence.clear();
  const std::vector<std::string> lines = lines_of(pairs_csv(bare));
  EXPECT_EQ(lines[0], lines_of(pairs_csv(testing::small_result()))[0]);
  EXPECT_NE(lines[0].find(",constraint,evidence_agreeing,evidence_agreeing_log_ratio,evidence_ambiguity,"),
            std::string::npos);
  EXPECT_NE(lines[1].find("," + std::string(24, ',')), std::string::npos) << lines[1];
  EXPECT_TRUE(lines[0].ends_with(",evidence_support_log_ratio,offset_rx,offset_ry,offset_rz")) << lines[0];
}

TEST(PairsCsv, CellsStandUnderTheirNames) {
  const std::vector<std::string> lines = lines_of(pairs_csv(testing::small_result()));
  const std::vector<std::string> names = cells_of(lines[0]);
  std::map<std::string, std::string> row, empty;
  for (std::size_t i = 0; i < names.size(); ++i) {
    row[names[i]] = cells_of(lines[2])[i];
    empty[names[i]] = cells_of(lines[3])[i];
  }
  const std::map<std::string, std::string> expected = {{"target", "a/1"},
                                                       {"source", "b/1"},
                                                       {"kind", "global"},
                                                       {"overlap", "0.41"},
                                                       {"matched", "18234"},
                                                       {"d", "1"},
                                                       {"mu", "0.031"},
                                                       {"sigma", "0.042"},
                                                       {"mu_t", "0.047"},
                                                       {"var_t", "0.0011"},
                                                       {"gamma", "19342"},
                                                       {"gamma_literal", "24177.5"},
                                                       {"theta", "20000.5"},
                                                       {"theta_oicp", "19999.25"},
                                                       {"verified", "658.5"},
                                                       {"offset_m", "0.43"},
                                                       {"offset_low_m", "0.39"},
                                                       {"offset_high_m", "0.47"},
                                                       {"offset_x", "0"},
                                                       {"offset_y", "-0.4"},
                                                       {"offset_z", "0.15"},
                                                       {"gap_m", "0.01"},
                                                       {"unobservable", "1"},
                                                       {"minimum_detectable_m", "0.03"},
                                                       {"p_value", "0.9"},
                                                       {"log_odds", "9"},
                                                       {"p_inconsistent", "0.97"},
                                                       {"verdict", "inconsistent"},
                                                       {"evidence_displacement", "0.02"},
                                                       {"evidence_displacement_log_ratio", "-4.5"}};
  for (const auto& [name, value] : expected) EXPECT_EQ(row.at(name), value) << name;
  for (const char* name : {"mu", "gamma", "theta", "verified", "offset_m", "offset_x", "unobservable", "p_inconsistent",
                           "evidence_displacement", "evidence_conflict_log_ratio"}) {
    EXPECT_EQ(empty.at(name), "") << name;
  }
  EXPECT_EQ(empty.at("verdict"), "unverified");
}

// To the left by a tenth of a radian, in a target that stands on its side: about its x axis.
TEST(PairsCsv, TheTurnIsAlongTheTargetsAxes) {
  Result result = testing::small_result();
  PairResult& pair = result.pairs[1];
  pair.verdict.offset_rad = 0.1;
  pair.T_target_source = Pose3::exp((Vector6() << 3.0, -2.0, 1.0, 0.7, -0.4, 1.5).finished());
  pair.T_target_source_registered =
      Pose3::exp((Vector6() << 0.2, 0.0, 0.0, 0.1, 0.0, 0.0).finished()) * pair.T_target_source;
  const std::vector<std::string> cells = cells_of(lines_of(pairs_csv(result))[2]);
  const auto cell = [&](std::size_t from_end) { return std::stod(cells[cells.size() - from_end]); };
  EXPECT_NEAR(cell(3), 0.1, 1e-12);
  EXPECT_NEAR(cell(2), 0.0, 1e-12);
  EXPECT_NEAR(cell(1), 0.0, 1e-12);
  EXPECT_TRUE(lines_of(pairs_csv(result))[3].ends_with(",,,"));
}

}  // namespace
}  // namespace kilter
