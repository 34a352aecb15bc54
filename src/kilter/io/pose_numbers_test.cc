// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/pose_numbers.h"

#include <gtest/gtest.h>

namespace kilter {
namespace {

Expected<Pose3> take(std::string_view text) {
  ByteCursor cursor(text);
  return take_matrix(cursor, "estimate", "data");
}

void expect_error(std::string_view text, ErrorCode code, const std::string& message_part) {
  const Expected<Pose3> pose = take(text);
  ASSERT_FALSE(pose) << text;
  EXPECT_EQ(error_code_name(pose.error().code), error_code_name(code)) << to_string(pose.error());
  EXPECT_NE(to_string(pose.error()).find(message_part), std::string::npos) << to_string(pose.error());
}

TEST(TakeMatrix, ReadsFourRowsAndLeavesTheRest) {
  ByteCursor cursor(" 0 -1 0 4\r\n 1  0 0 5\r\n\r\n0 0 1 6\n-0 0 0 1\nodom\n");
  const auto pose = take_matrix(cursor, "estimate", "data");
  ASSERT_TRUE(pose) << to_string(pose.error());
  EXPECT_LT((*pose * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(4, 6, 6)).norm(), 1e-12);
  EXPECT_EQ(cursor.rest(), "odom\n");
}

TEST(TakeMatrix, NamesItsLineAndWhatWasExpected) {
  expect_error("1 0 0 0\n0 1 0 0\n", ErrorCode::kTruncated,
               "data:2: estimate: expected 4 rows of 4 numbers, the file ends after 2");
  expect_error("1 0 0 0\n0 1 0\n", ErrorCode::kParse, "data:2: estimate: column 4: expected a number, found \"\"");
  expect_error("1 0 0 0 0\n", ErrorCode::kParse, "data:1: estimate: expected 4 columns, found more: \"0\"");
  expect_error("1 0 0 a\n", ErrorCode::kParse, "found \"a\"");
}

TEST(TakeMatrix, RefusesMatricesThatAreNotRigid) {
  const std::string end = "0 1 0 0\n0 0 1 0\n0 0 0 1\n";
  EXPECT_TRUE(take("1 0 0 0\n" + end));
  expect_error("nan 0 0 0\n" + end, ErrorCode::kInvalidPose, "data:1: estimate: column 1 is nan");
  expect_error("1 0 0 inf\n" + end, ErrorCode::kInvalidPose, "column 4 is inf");
  expect_error("1 0 0 1e9\n" + end, ErrorCode::kInvalidPose, "farther than");
  expect_error("2 0 0 0\n" + end, ErrorCode::kInvalidPose, "not a rotation");
  expect_error("-1 0 0 0\n" + end, ErrorCode::kInvalidPose, "reflection");
  expect_error("1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 2\n", ErrorCode::kInvalidPose,
               "data:4: estimate: expected 0 0 0 1 as the last row of a rigid matrix, found 0 0 0 2");
}

}  // namespace
}  // namespace kilter
