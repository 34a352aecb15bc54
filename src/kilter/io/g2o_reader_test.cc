// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/g2o_reader.h"

#include <gtest/gtest.h>

namespace kilter {
namespace {

void expect_error(std::string_view text, ErrorCode code, const std::string& message_part) {
  const auto vertices = read_g2o_vertices(text, "graph.g2o");
  ASSERT_FALSE(vertices) << text;
  EXPECT_EQ(error_code_name(vertices.error().code), error_code_name(code)) << to_string(vertices.error());
  EXPECT_NE(to_string(vertices.error()).find(message_part), std::string::npos) << to_string(vertices.error());
}

TEST(ReadG2oVertices, GivesPosesInOrderOfTheirIdsAndSkipsTheRest) {
  const auto vertices = read_g2o_vertices(
      "\xEF\xBB\xBF# a graph\r\nPARAMS_SE3OFFSET 0 0 0 0 0 0 0 1\r\nVERTEX_SE3:QUAT 7 1 2 3 0 0 1 0\r\n\r\n"
      "FIX 7\r\nVERTEX_SE3:QUAT 18446744073709551615 0 0 0 0 0 0 1 # last\r\nVERTEX_TRACKXYZ 3 0 0 0\r\n"
      "VERTEX_SE3:QUAT 2 -1 +2e0 .5 0 0 0 1.005\r\nEDGE_SE3:QUAT 2 7 0 0 0 0 0 0 1",
      "g");
  ASSERT_TRUE(vertices) << to_string(vertices.error());
  ASSERT_EQ(vertices->size(), 3U);
  EXPECT_EQ((*vertices)[0].id, 2U);
  EXPECT_EQ((*vertices)[0].T_world_cloud.translation_m(), Eigen::Vector3d(-1, 2, 0.5));
  EXPECT_NEAR((*vertices)[0].T_world_cloud.angle_rad(), 0.0, 1e-15);
  EXPECT_EQ((*vertices)[1].id, 7U);
  EXPECT_EQ((*vertices)[1].T_world_cloud * Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 2, 3));
  EXPECT_EQ((*vertices)[2].id, UINT64_MAX);
}

TEST(ReadG2oVertices, NamesLineColumnExpectedAndFound) {
  const std::string good = "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n";
  expect_error(good + "VERTEX_SE3:QUAT -1 0 0 0 0 0 0 1", ErrorCode::kParse,
               "graph.g2o:2: column 2: expected the vertex's id, a whole number, found \"-1\"");
  expect_error(good + "VERTEX_SE3:QUAT 1 0 0 x\x1B 0 0 0 1", ErrorCode::kParse,
               "column 5: expected a number, found \"x?\"");
  expect_error(good + "VERTEX_SE3:QUAT 1 0 0 0 0 0 0", ErrorCode::kParse, "column 9: expected a number, found \"\"");
  expect_error("VERTEX_SE3:QUAT 1 0 0 0 0 0 0 1 9", ErrorCode::kParse, "expected 9 columns, found more: \"9\"");
  expect_error(good + "\n" + good, ErrorCode::kParse, "graph.g2o:3: vertex 0 is given twice, first in line 1");
}

TEST(G2oVertexNames, AreThoseOfCommentsThatNameASubmap) {
  const auto names = g2o_vertex_names(
      "# kilter: submaps as vertices, T_world_submap\n"
      "# a/1\nVERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\r\n"
      "VERTEX_SE3:QUAT 1 0 0 0 0 0 0 1 # robot b/12\n"
      "# see notes/2024 for more\nVERTEX_SE3:QUAT 2 0 0 0 0 0 0 1\n"
      "# a/3\n\nVERTEX_SE3:QUAT 3 0 0 0 0 0 0 1\n"
      "# a/1 <- a/2\nVERTEX_SE3:QUAT 4 0 0 0 0 0 0 1\n");
  EXPECT_EQ(names, (std::map<std::uint64_t, std::string>{{0, "a/1"}, {1, "robot b/12"}}));
}

TEST(ReadG2oVertices, RefusesPosesThatAreNone) {
  expect_error("VERTEX_SE3:QUAT 1 0 nan 0 0 0 0 1", ErrorCode::kInvalidPose, "graph.g2o:1: column 4 is nan");
  expect_error("VERTEX_SE3:QUAT 1 0 1e400 0 0 0 0 1", ErrorCode::kInvalidPose, "column 4 is inf");
  expect_error("VERTEX_SE3:QUAT 1 0 1e9 0 0 0 0 1", ErrorCode::kInvalidPose, "farther than");
  expect_error("VERTEX_SE3:QUAT 1 0 0 0 0 0 0 0", ErrorCode::kInvalidPose, "length 0");
}

TEST(ReadG2oVertices, RefusesGraphsWithoutPosesInSpace) {
  expect_error("", ErrorCode::kEmptyInput, "no VERTEX_SE3:QUAT");
  expect_error("EDGE_SE3:QUAT 0 1\n", ErrorCode::kEmptyInput, "no VERTEX_SE3:QUAT");
  expect_error("VERTEX_SE2 0 0 0 0\n", ErrorCode::kUnsupported, "planar");
}

}  // namespace
}  // namespace kilter
