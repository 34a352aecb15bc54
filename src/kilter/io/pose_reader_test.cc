// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/pose_reader.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numbers>
#include <string>

#include "kilter/base/rng.h"

namespace kilter {
namespace {

Pose3 only(const std::string& line) {
  const auto poses = read_poses(line, "poses.tum");
  if (!poses) {
    ADD_FAILURE() << to_string(poses.error());
    return {};
  }
  EXPECT_EQ(poses->size(), 1U);
  return poses->front();
}

void expect_error(const std::string& text, ErrorCode code, const std::string& message_part) {
  const auto poses = read_poses(text, "poses.tum");
  ASSERT_FALSE(poses) << message_part;
  EXPECT_EQ(error_code_name(poses.error().code), error_code_name(code)) << to_string(poses.error());
  EXPECT_NE(to_string(poses.error()).find(message_part), std::string::npos) << to_string(poses.error());
}

double difference(const Pose3& a, const Pose3& b) { return (a.inverse() * b).log().norm(); }

TEST(ReadPoses, TakesEightColumnsAsTum) {
  const double h = std::numbers::sqrt2 / 2;
  const Pose3 T = only(fmt::format("12.5 1 2 3 0 0 {} {}\n", h, h));
  EXPECT_EQ(T.translation_m(), Eigen::Vector3d(1, 2, 3));
  // A quarter turn to the left takes x to y.
  EXPECT_LT((T * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(1, 3, 3)).norm(), 1e-12);
}

TEST(ReadPoses, TakesTwelveColumnsAsRowsOfAMatrix) {
  const Pose3 T = only("0 -1 0 1 1 0 0 2 0 0 1 3\n");
  EXPECT_EQ(T.translation_m(), Eigen::Vector3d(1, 2, 3));
  EXPECT_LT((T * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(1, 3, 3)).norm(), 1e-12);
}

TEST(ReadPoses, ReadsTheSamePoseFromBothLayouts) {
  Rng rng(7, 0);
  for (int i = 0; i < 100; ++i) {
    Vector6 xi;
    for (double& v : xi) v = rng.normal();
    const Pose3 T = Pose3::exp(xi);
    const Eigen::Vector3d t = T.translation_m();
    const Eigen::Quaterniond q = T.rotation();
    const Eigen::Matrix3d R = T.rotation_matrix();
    const Pose3 tum = only(fmt::format("{} {} {} {} {} {} {} {}", i, t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()));
    std::string rows;
    for (int r = 0; r < 3; ++r) rows += fmt::format("{} {} {} {} ", R(r, 0), R(r, 1), R(r, 2), t[r]);
    EXPECT_LT(difference(T, tum), 1e-14);
    EXPECT_LT(difference(T, only(rows)), 1e-14);
  }
}

TEST(ReadPoses, PassesOverCommentsBlankLinesAndCommas) {
  const auto poses =
      read_poses("\xEF\xBB\xBF# t x y z qx qy qz qw\r\n\r\n0,1,2,3,0,0,0,1\r\n 1, +4 5\t6 0 0 0 1 # last\r\n", "p");
  ASSERT_TRUE(poses) << to_string(poses.error());
  ASSERT_EQ(poses->size(), 2U);
  EXPECT_EQ((*poses)[0].translation_m(), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ((*poses)[1].translation_m(), Eigen::Vector3d(4, 5, 6));
}

TEST(ReadPoses, NormalisesQuaternionsWithinOnePercent) {
  EXPECT_LT(difference(only("0 0 0 0 0 0 0 0.991"), Pose3()), 1e-15);
  EXPECT_LT(difference(only("0 0 0 0 0 0 0 -1.009"), Pose3()), 1e-15);
  expect_error("0 0 0 0 0 0 0 0.989", ErrorCode::kInvalidPose, "length 0.989");
  expect_error("0 0 0 0 0 0 0 1.011", ErrorCode::kInvalidPose, "length 1.011");
  expect_error("0 0 0 0 0 0 0 0", ErrorCode::kInvalidPose, "length 0");
  expect_error("0 0 0 0 1e200 1e200 0 0", ErrorCode::kInvalidPose, "length 1.41421e+200");
}

TEST(ReadPoses, MovesNearlyRigidMatricesToTheNearestRotation) {
  const Pose3 T = only("1.004 0 0 0 0 0.998 0 0 0 0 1 0");
  EXPECT_LT(difference(T, Pose3()), 1e-12);
  expect_error("1.01 0 0 0 0 1 0 0 0 0 1 0", ErrorCode::kInvalidPose, "R^T R differs from I by 0.0201");
  expect_error("1 0.02 0 0 0 1 0 0 0 0 1 0", ErrorCode::kInvalidPose, "not a rotation");
  expect_error("0 0 0 0 0 0 0 0 0 0 0 0", ErrorCode::kInvalidPose, "not a rotation");
  expect_error("1e200 0 0 0 0 1 0 0 0 0 1 0", ErrorCode::kInvalidPose, "not a rotation");
  expect_error("1 0 0 0 0 1 0 0 0 0 -1 0", ErrorCode::kInvalidPose, "reflection");
}

TEST(ReadPoses, RefusesWhatIsNotFiniteOrNotOnEarth) {
  expect_error("0 nan 0 0 0 0 0 1", ErrorCode::kInvalidPose, "column 2 is nan");
  expect_error("inf 0 0 0 0 0 0 1", ErrorCode::kInvalidPose, "column 1 is inf");
  expect_error("0 0 0 0 0 0 0 nan", ErrorCode::kInvalidPose, "column 8 is nan");
  expect_error("1 0 0 1e400 0 1 0 0 0 0 1 0", ErrorCode::kInvalidPose, "column 4 is inf");
  expect_error("0 1e9 0 0 0 0 0 1", ErrorCode::kInvalidPose, "farther than");
}

TEST(ReadPoses, NamesLineFoundAndExpectedColumns) {
  const std::string good = "0 0 0 0 0 0 0 1\n";
  expect_error(good + "\n" + good + "0 0 0 0 0 0 1\n", ErrorCode::kParse,
               "poses.tum:4: expected 8 columns as in the lines before, found 7");
  expect_error(good + "1 0 0 0 0 1 0 0 0 0 1 0\n", ErrorCode::kParse, "poses.tum:2: expected 8 columns");
  for (const char* line : {"1", "0 0 0 0 0 0 1", "0 0 0 0 0 0 0 1 0", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"}) {
    expect_error(line, ErrorCode::kParse, "expected 8 or 12 columns, found");
  }
  expect_error("0 0 0 0 0 0 0 1\n0 0 0 0 0 0 0 1x\n", ErrorCode::kParse,
               "poses.tum:2: column 8: expected a number, found \"1x\"");
  expect_error("timestamp x y z qx qy qz qw\n", ErrorCode::kParse, "found \"timestamp\"");
  expect_error(std::string("0\0 0 0 0 0 0 0 1\n", 17), ErrorCode::kParse, "found \"0?\"");
}

TEST(ReadPoses, RefusesAFileWithoutAnyPose) {
  for (const char* text : {"", "\n\n", "# nothing\n", "\xEF\xBB\xBF"}) {
    expect_error(text, ErrorCode::kEmptyInput, "poses.tum: the file holds no pose");
  }
}

}  // namespace
}  // namespace kilter
