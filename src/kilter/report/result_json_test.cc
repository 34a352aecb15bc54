// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/report/result_json.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "kilter/base/version.h"
#include "testing/results.h"

namespace kilter {
namespace {

using nlohmann::json;

struct SampleOptions {
  double tolerance_m = 0.1;
  int min_scans = 3;
  bool literal = true;
  MapState word = MapState::kInconsistent;

  [[nodiscard]] ConfigEcho echo() {
    ConfigEcho config;
    config.options = {real_option("tolerance", tolerance_m, Unit::kMetre, 0.001, 10.0, "What can be lived with."),
                      count_option("min_scans", min_scans, 1, 100, "Scans."),
                      flag_option("literal", literal, "A flag."),
                      choice_option("word", word, {"consistent", "inconsistent", "undetermined"}, "A word.")};
    return config;
  }
};

RunInfo sample_run() { return {{"mission"}, std::nullopt, "old", "new.g2o", 2, 1000000, "2024-05-01T12:00:00Z"}; }

std::string text_of(const Result& result) { return result_json(result, SampleOptions().echo(), sample_run()); }

// Exit status of Debian's JSON Schema validator over the text.
int validate(const std::string& text) {
  const auto file = std::filesystem::temp_directory_path() / ("kilter_schema_test_" + std::to_string(::getpid()));
  std::ofstream(file) << text;
  const std::string schema = std::string(std::getenv("KILTER_SOURCE_DIR")) + "/docs/result.schema.json";
  const int status =
      std::system(("/usr/bin/python3 -W ignore -m jsonschema -i " + file.string() + " " + schema + " 2>&1").c_str());
  std::filesystem::remove(file);
  return status;
}

TEST(ResultJson, FollowsTheSchemaWithEverythingMeasured) {
  Result result = testing::result_of({{"a", 3}, {"b", 2}});
  testing::add_measured_pair(result, 1, 0);
  testing::add_measured_pair(result, 2, 0);
  testing::add_measured_pair(result, 3, 0);
  EXPECT_EQ(validate(text_of(result)), 0) << text_of(result);
}

TEST(ResultJson, FollowsTheSchemaWithNothingMeasured) {
  Result result = testing::result_of({{"a", 2}, {"b", 1}});
  result.submaps[0].scans.reset();
  testing::add_empty_pair(result, 1, 0);
  EXPECT_EQ(validate(text_of(result)), 0);
  EXPECT_EQ(validate(text_of(Result())), 0);
}

TEST(ResultJson, FollowsTheSchemaForEachVerdict) {
  Result result = testing::small_result();
  EXPECT_EQ(validate(text_of(result)), 0);
  for (const MapState state : {MapState::kConsistent, MapState::kUndetermined}) {
    result.system.state = state;
    EXPECT_EQ(validate(text_of(result)), 0);
  }
}

TEST(ResultJson, TheSchemaRefusesWhatIsNotPromised) {
  const json good = json::parse(text_of(testing::small_result()));
  json changed = good;
  changed["pairs"][0]["extra"] = 1;
  EXPECT_NE(validate(changed.dump()), 0) << "a key more";
  changed = good;
  changed["pairs"][0].erase("theta");
  EXPECT_NE(validate(changed.dump()), 0) << "a key less";
  changed = good;
  changed["system"]["verdict"] = "fine";
  EXPECT_NE(validate(changed.dump()), 0) << "another word";
  changed = good;
  changed["pairs"][0]["covariance"].erase(35);
  EXPECT_NE(validate(changed.dump()), 0) << "35 numbers for a 6x6 matrix";
}

TEST(ResultJson, WhatIsAbsentIsNull) {
  Result result = testing::result_of({{"a", 2}});
  testing::add_empty_pair(result, 1, 0);
  const json pair = json::parse(text_of(result))["pairs"][0];
  for (const char* key : {"histogram",
                          "mu",
                          "sigma",
                          "mu_t",
                          "var_t",
                          "gamma",
                          "gamma_literal",
                          "theta",
                          "theta_oicp",
                          "verified",
                          "offset_m",
                          "offset_interval_m",
                          "offset_deg",
                          "offset_vector",
                          "gap_m",
                          "minimum_detectable_m",
                          "unobservable",
                          "p_value",
                          "log_odds",
                          "p_inconsistent",
                          "T_target_source_registered",
                          "covariance"}) {
    EXPECT_TRUE(pair.at(key).is_null()) << key;
  }
  EXPECT_EQ(pair["verdict"], "unverified");
  EXPECT_EQ(pair["reason"], "too little overlap");
}

TEST(ResultJson, CarriesEveryNumberOfAPair) {
  const Result result = testing::small_result();
  const json root = json::parse(text_of(result));
  const json& pair = root["pairs"][1];
  EXPECT_EQ(pair["target"], "a/1");
  EXPECT_EQ(pair["source"], "b/1");
  EXPECT_EQ(pair["kind"], "global");
  EXPECT_EQ(pair["matched"], 18234);
  EXPECT_EQ(pair["histogram"]["counts"], json({10, 7, 3, 0, 1}));
  EXPECT_EQ(pair["mu"].get<double>(), 0.031);
  EXPECT_EQ(pair["var_t"].get<double>(), 0.0011);
  EXPECT_EQ(pair["gamma"].get<double>(), 19342.0);
  EXPECT_EQ(pair["gamma_literal"].get<double>(), 19342.0 * 1.25);
  EXPECT_EQ(pair["theta"].get<double>(), 20000.5);
  EXPECT_EQ(pair["verified"].get<double>(), 658.5);
  EXPECT_EQ(pair["evidence"]["displacement"]["log_ratio"].get<double>(), -4.5);
  EXPECT_TRUE(pair["evidence"]["conflict"]["null"].is_null());
  EXPECT_EQ(pair["offset_interval_m"], json({0.39, 0.47}));
  EXPECT_EQ(pair["offset_deg"].get<double>(), 0.03 * 180.0 / std::numbers::pi);
  EXPECT_EQ(pair["unobservable"], json({{1.0, 0.0, 0.0, 0.0, 0.0, 0.0}}));
  EXPECT_EQ(pair["T_target_source_registered"], json({0.52, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0}));
  EXPECT_EQ(pair["covariance"][14].get<double>(), 4e-6);
  EXPECT_EQ(root["submaps"][2]["T_world_submap"][2].get<double>(), 1.0 / 3.0);
  EXPECT_EQ(root["submaps"][1]["first_scan"], 10);
  EXPECT_EQ(root["submaps"][1]["last_scan"], 19);
  EXPECT_EQ(root["version"], std::string(kVersion));
  EXPECT_EQ(root["system"]["verdict"], "inconsistent");
  EXPECT_EQ(root["system"]["consistent"], false);
  EXPECT_EQ(root["system"]["certificate_excludes"], json::parse(R"([["a/2", "b/1"]])"));
  EXPECT_EQ(root["system"]["log_probability"]["sequential"]["a"].get<double>(), -0.0025);
  EXPECT_TRUE(root["system"]["decided"]["local"].is_null());
}

TEST(ResultJson, CovarianceIsWrittenRowByRow) {
  Result result = testing::result_of({{"a", 2}});
  PairResult& pair = testing::add_measured_pair(result, 1, 0);
  (*pair.covariance)(0, 5) = 7.0;
  EXPECT_EQ(json::parse(text_of(result))["pairs"][0]["covariance"][5].get<double>(), 7.0);
}

TEST(ResultJson, OptionsKeepTheirKinds) {
  SampleOptions options;
  ConfigEcho echo = options.echo();
  echo.T_body_sensor["a"] = Pose3::from_translation(0.0, 0.0, 1.5);
  const json config = json::parse(result_json(Result(), echo, sample_run()))["config"];
  EXPECT_EQ(config["tolerance"].get<double>(), 0.1);
  EXPECT_EQ(config["min_scans"], 3);
  EXPECT_EQ(config["literal"], true);
  EXPECT_EQ(config["word"], "inconsistent");
  EXPECT_EQ(config["T_body_sensor"]["a"][2].get<double>(), 1.5);
}

TEST(ResultJson, OnlyTheRunCarriesWhatDiffersBetweenRuns) {
  Result result = testing::small_result();
  SampleOptions options;
  json one = json::parse(result_json(result, options.echo(), sample_run()));
  result.seconds["pairs"] = 99.0;
  RunInfo other = sample_run();
  other.jobs = 7;
  other.sources = {"elsewhere"};
  json two = json::parse(result_json(result, options.echo(), other));
  EXPECT_NE(one["run"], two["run"]);
  one.erase("run");
  two.erase("run");
  EXPECT_EQ(one, two);
}

TEST(ConfigDigest, ChangesWithAnyValueAndWithNothingElse) {
  SampleOptions a, b;
  EXPECT_EQ(config_digest(a.echo()), config_digest(b.echo()));
  EXPECT_EQ(config_digest(a.echo()).size(), 16U);
  b.tolerance_m = std::nextafter(0.1, 1.0);
  EXPECT_NE(config_digest(a.echo()), config_digest(b.echo()));
  ConfigEcho mounted = a.echo();
  mounted.T_body_sensor["a"] = Pose3();
  EXPECT_NE(config_digest(a.echo()), config_digest(mounted));
}

}  // namespace
}  // namespace kilter
