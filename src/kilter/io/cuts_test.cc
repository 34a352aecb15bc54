// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/cuts.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "testing/temp_folder.h"

namespace kilter {
namespace {

using kilter_testing::TempFolder;

std::string result(const std::string& submaps) {
  return fmt::format(
      R"({{"schema": "kilter.result/1", "pairs": [{{"histogram": {{"counts": [1, 2]}}}}], "submaps": {}}})", submaps);
}

std::string submap(std::string_view robot, std::string_view first, std::string_view last) {
  return fmt::format(R"({{"id": "x", "robot": "{}", "first_scan": {}, "last_scan": {}}})", robot, first, last);
}

std::string result_of(const std::vector<std::string>& submaps) {
  return result(fmt::format("[{}]", fmt::join(submaps, ", ")));
}

void expect_error(const std::string& text, ErrorCode code, const std::string& message_part) {
  const auto cuts = parse_cuts(text, "result.json");
  ASSERT_FALSE(cuts) << message_part;
  EXPECT_EQ(error_code_name(cuts.error().code), error_code_name(code)) << to_string(cuts.error());
  EXPECT_NE(to_string(cuts.error()).find(message_part), std::string::npos) << to_string(cuts.error());
}

TEST(ParseCuts, TakesEachRobotsRangesOfScans) {
  const auto cuts = parse_cuts(result_of({submap("b", "0", "4"), submap("a", "0", "13"), submap("a", "14", "14")}), "");
  ASSERT_TRUE(cuts) << to_string(cuts.error());
  EXPECT_EQ(*cuts, (Cuts{{"a", {{0, 13}, {14, 14}}}, {"b", {{0, 4}}}}));
}

TEST(ParseCuts, RefusesRangesWithGapsOrOverlaps) {
  const auto two = [](const std::string& first, const std::string& last) {
    return result_of({submap("a", "0", "13"), submap("a", first, last)});
  };
  expect_error(two("15", "20"), ErrorCode::kParse,
               "submaps[1]: scans 15 to 20: expected a range that begins at scan 14");
  expect_error(two("13", "20"), ErrorCode::kParse, "begins at scan 14");
  expect_error(two("14", "13"), ErrorCode::kParse, "scans 14 to 13");
  expect_error(result_of({submap("a", "1", "2")}), ErrorCode::kParse, "begins at scan 0");
}

TEST(ParseCuts, SaysWhatItTakesOfWhatIsNoJson) {
  expect_error("KILTER\x01\x02", ErrorCode::kParse, "result.json: not valid JSON at byte 1\n");
  expect_error(R"({"schema": )", ErrorCode::kParse, "not valid JSON at byte 12\n");
  expect_error("", ErrorCode::kParse, "try: --cuts takes the output folder of `kilter check`, or its result.json");
  expect_error("[1]", ErrorCode::kParse, "try: --cuts takes the output folder of `kilter check`, or its result.json");
}

TEST(ParseCuts, RefusesFinishedSubmaps) {
  expect_error(result_of({submap("a", "null", "null")}), ErrorCode::kUnsupported, "finished submaps");
}

TEST(ParseCuts, RefusesKeysThatAreMissingOrOfAnotherType) {
  for (const char* value : {"-1", "1.5", "\"1\"", "[]", "18446744073709551615", "99999999999999999999"}) {
    expect_error(result_of({submap("a", value, "3")}), ErrorCode::kParse, "expected first_scan to be a whole number");
    expect_error(result_of({submap("a", "0", value)}), ErrorCode::kParse, "expected last_scan to be a whole number");
  }
  expect_error(result(R"([{"robot": "a", "last_scan": 3}])"), ErrorCode::kParse, "first_scan");
  expect_error(result(R"([{"robot": 1}])"), ErrorCode::kParse, "key \"robot\"");
  expect_error(result("[7]"), ErrorCode::kParse, "key \"robot\"");
  expect_error(result("{}"), ErrorCode::kParse, "\"submaps\" with a list");
  expect_error(R"({"schema": "kilter.result/1"})", ErrorCode::kParse, "\"submaps\" with a list");
  expect_error(result("[]"), ErrorCode::kEmptyInput, "no submap");
}

TEST(ParseCuts, RefusesOtherFiles) {
  expect_error("", ErrorCode::kParse, "not valid JSON");
  expect_error("{\"schema\": ", ErrorCode::kParse, "not valid JSON");
  expect_error("[]", ErrorCode::kParse, "no result of kilter");
  expect_error("7", ErrorCode::kParse, "no result of kilter");
  expect_error("{}", ErrorCode::kParse, "no result of kilter");
  expect_error(R"({"schema": "kilter.result/2", "submaps": []})", ErrorCode::kUnsupported, "\"kilter.result/2\"");
}

TEST(ParseCuts, BoundsTheDepth) {
  const std::string deep = std::string(100'000, '[') + std::string(100'000, ']');
  expect_error(deep, ErrorCode::kParse, "nested more than");
  expect_error(result(fmt::format(R"([{}], "x": {})", submap("a", "0", "3"), deep)), ErrorCode::kParse,
               "nested more than");
  expect_error(std::string(1'000'000, '['), ErrorCode::kParse, "not valid JSON");
}

TEST(ReadCuts, TakesAFileOrAnOutputFolder) {
  const TempFolder folder;
  const auto file = folder.write("out/result.json", result_of({submap("a", "0", "3")}));
  EXPECT_EQ(read_cuts(file).value().at("a").size(), 1U);
  EXPECT_EQ(read_cuts(file.parent_path()).value().at("a").size(), 1U);
}

TEST(ReadCuts, SaysWhatItTakesWhereThereIsNoResult) {
  const TempFolder folder;
  for (const auto& path : {folder.path(), folder.path() / "none"}) {
    const auto cuts = read_cuts(path);
    ASSERT_FALSE(cuts.has_value());
    EXPECT_EQ(cuts.error().code, ErrorCode::kNotFound);
    EXPECT_EQ(cuts.error().where, path.string());
    EXPECT_THAT(cuts.error().hint, testing::HasSubstr("the output folder of `kilter check`"));
  }
  EXPECT_THAT(read_cuts(folder.path()).error().message, testing::HasSubstr("found no result.json in it"));
}

TEST(PosesOfResult, TellsWithWhichPosesTheMapWasDrawn) {
  const TempFolder folder;
  const auto with = [&](const std::string& run) {
    return poses_of_result(folder.write("out/result.json", R"({"schema": "kilter.result/1", "run": )" + run + "}"));
  };
  EXPECT_EQ(with(R"({"poses": "truth", "jobs": 2})"), "truth");
  EXPECT_EQ(with(R"({"poses": null})"), std::nullopt);
  EXPECT_EQ(with("[3]"), std::nullopt);
  EXPECT_EQ(with("{"), std::nullopt);
  EXPECT_EQ(poses_of_result(folder.path() / "none"), std::nullopt);
}

}  // namespace
}  // namespace kilter
