// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/submap_poses.h"

#include <gtest/gtest.h>

#include <cmath>

namespace kilter {
namespace {

RobotLog robot(const std::string& name, std::size_t scans) {
  RobotLog log;
  log.name = name;
  for (std::size_t k = 0; k < scans; ++k) log.T_world_cloud.push_back(Pose3::from_translation(double(k), 0.0, 0.0));
  return log;
}

std::vector<Eigen::Vector3d> places(const RobotLog& log) {
  std::vector<Eigen::Vector3d> found;
  for (const Pose3& pose : log.T_world_cloud) found.push_back(pose.translation_m());
  return found;
}

void expect_at(const RobotLog& log, const std::vector<Eigen::Vector3d>& expected) {
  const std::vector<Eigen::Vector3d> found = places(log);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t k = 0; k < found.size(); ++k) {
    EXPECT_NEAR((found[k] - expected[k]).norm(), 0.0, 1e-9) << "cloud " << k << " at " << found[k].transpose();
  }
}

// The first submap of a moves up, its second turns to the left about its first scan; b's moves aside.
constexpr std::string_view kGraph =
    "VERTEX_SE3:QUAT 2 0 7 0 0 0 0 1\n"
    "VERTEX_SE3:QUAT 0 0 0 5 0 0 0 1 # a/1\n"
    "VERTEX_SE3:QUAT 1 2 0 0 0 0 0.7071067811865476 0.7071067811865476\n"
    "EDGE_SE3:QUAT 0 1 2 0 0 0 0 0 1 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n";

TEST(MoveSubmaps, ScansGoWithTheirSubmapAsOneBody) {
  std::vector<RobotLog> robots = {robot("a", 4), robot("b", 2)};
  const Cuts cuts = {{"a", {{0, 1}, {2, 3}}}, {"b", {{0, 1}}}};
  const auto moved = move_submaps(kGraph, "new.g2o", cuts, robots);
  ASSERT_TRUE(moved) << to_string(moved.error());
  expect_at(robots[0], {{0, 0, 5}, {1, 0, 5}, {2, 0, 0}, {2, 1, 0}});
  expect_at(robots[1], {{0, 7, 0}, {1, 7, 0}});
  ASSERT_EQ(moved->size(), 3U);
  EXPECT_NEAR((*moved)[0].distance_m, 5.0, 1e-12);
  EXPECT_NEAR((*moved)[0].angle_rad, 0.0, 1e-7);
  EXPECT_NEAR((*moved)[1].distance_m, 0.0, 1e-12);
  EXPECT_NEAR((*moved)[1].angle_rad, M_PI / 2.0, 1e-7);
  EXPECT_NEAR((*moved)[2].distance_m, 7.0, 1e-12);
}

TEST(MoveSubmaps, RefusesAGraphWhoseCommentsNameOtherSubmaps) {
  std::vector<RobotLog> robots = {robot("a", 2), robot("b", 1)};
  for (RobotLog& log : robots) log.finished_submaps = true;
  const std::string vertices =
      "# a/1\nVERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n# {}\nVERTEX_SE3:QUAT 1 0 0 0 0 0 0 1\n"
      "VERTEX_SE3:QUAT 2 0 0 0 0 0 0 1 # the last one\n";
  const auto named = [&](const std::string& name) {
    std::string graph = vertices;
    return graph.replace(graph.find("{}"), 2, name);
  };
  EXPECT_TRUE(move_submaps(named("a/2"), "new.g2o", {}, robots));
  EXPECT_TRUE(move_submaps(named("of 2024"), "new.g2o", {}, robots)) << "no name of a submap";
  const auto refused = move_submaps(named("b/1"), "new.g2o", {}, robots);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kCountMismatch);
  EXPECT_EQ(refused.error().message, "vertex 1 is called b/1, but that submap here is a/2");
}

TEST(MoveSubmaps, FinishedSubmapsNeedNoCuts) {
  std::vector<RobotLog> robots = {robot("a", 2), robot("b", 1)};
  for (RobotLog& log : robots) log.finished_submaps = true;
  ASSERT_TRUE(move_submaps(kGraph, "new.g2o", {}, robots));
  expect_at(robots[0], {{0, 0, 5}, {2, 0, 0}});
  expect_at(robots[1], {{0, 7, 0}});
}

void expect_refused(std::string_view graph, const Cuts& cuts, ErrorCode code, const std::string& part) {
  std::vector<RobotLog> robots = {robot("a", 4), robot("b", 2)};
  const auto before = places(robots[0]);
  const auto moved = move_submaps(graph, "new.g2o", cuts, robots);
  ASSERT_FALSE(moved) << part;
  EXPECT_EQ(error_code_name(moved.error().code), error_code_name(code)) << to_string(moved.error());
  EXPECT_NE(to_string(moved.error()).find(part), std::string::npos) << to_string(moved.error());
  EXPECT_EQ(places(robots[0]), before);
}

TEST(MoveSubmaps, SaysWhatDoesNotFit) {
  const Cuts cuts = {{"a", {{0, 1}, {2, 3}}}, {"b", {{0, 1}}}};
  expect_refused(kGraph, {{"a", {{0, 3}}}, {"b", {{0, 1}}}}, ErrorCode::kCountMismatch,
                 "3 vertices, the last with id 2, but there are 2 submaps");
  expect_refused("VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 3 0 0 0 0 0 0 1\n",
                 cuts, ErrorCode::kCountMismatch, "the last with id 3");
  expect_refused(kGraph, {{"a", {{0, 1}, {2, 3}}}}, ErrorCode::kCountMismatch, "robot b");
  expect_refused(kGraph, {{"a", {{0, 1}, {2, 4}}}, {"b", {{0, 1}}}}, ErrorCode::kCountMismatch,
                 "--cuts knows 5 scans of robot a, but there are 4");
  expect_refused("EDGE_SE3:QUAT 0 1 2 0 0 0 0 0 1\n", cuts, ErrorCode::kEmptyInput, "new.g2o");
  expect_refused("VERTEX_SE3:QUAT 0 0 0 0 0 0 0\n", cuts, ErrorCode::kParse, "new.g2o");
}

}  // namespace
}  // namespace kilter
