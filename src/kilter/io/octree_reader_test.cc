// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/octree_reader.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "testing/allocation_watch.h"
#include "testing/octree_bytes.h"
#include "testing/temp_folder.h"

namespace kilter {
namespace {

using kilter_testing::full_octree;
using kilter_testing::octree_node;
using kilter_testing::OctreeBytes;

void expect_error(const Expected<OccupancyCells>& known, ErrorCode code, const std::string& part) {
  ASSERT_FALSE(known) << part;
  EXPECT_EQ(error_code_name(known.error().code), error_code_name(code)) << to_string(known.error());
  EXPECT_NE(to_string(known.error()).find(part), std::string::npos) << to_string(known.error());
}

TEST(OctreeReader, FindsALeafAtTheOriginBySixteenSteps) {
  // The cell [0, 0.1)^3 has key 32768 on each axis: child 7 of the root, child 0 from there on.
  const auto known = read_octree(full_octree().str(), "f");
  ASSERT_TRUE(known) << to_string(known.error());
  EXPECT_EQ(known->resolution_m, 0.1);
  ASSERT_EQ(known->cells.size(), 2U);
  EXPECT_EQ(known->cells[0].index, (std::array<std::int16_t, 3>{0, 0, 0}));
  EXPECT_EQ(known->cells[0].level, 0);
  EXPECT_EQ(known->cells[0].log_odds, 0.85F);
  // The last step's child 5: one step along x and z.
  EXPECT_EQ(known->cells[1].index, (std::array<std::int16_t, 3>{1, 0, 1}));
  EXPECT_EQ(known->cells[1].log_odds, -0.4F);
}

TEST(OctreeReader, KeepsLargeLeavesAsCubes) {
  // The root's children 0 (all coordinates negative) and 6 (x negative) are leaves.
  OctreeBytes tree;
  tree.size = "3";
  tree.body = octree_node(1.5F, 0b01000001) + octree_node(-2.0F, 0) + octree_node(1.5F, 0);
  const auto known = read_octree(tree.str(), "f");
  ASSERT_TRUE(known) << to_string(known.error());
  ASSERT_EQ(known->cells.size(), 2U);
  EXPECT_EQ(known->cells[0].index, (std::array<std::int16_t, 3>{-32768, -32768, -32768}));
  EXPECT_EQ(known->cells[1].index, (std::array<std::int16_t, 3>{-32768, 0, 0}));
  EXPECT_EQ(known->cells[1].level, 15);
}

TEST(OctreeReader, ReadsTwoBitsAChildOfBinaryTrees) {
  // Child 0 free, 1 occupied, 3 an inner node, 7 occupied; of the inner one, child 2 free.
  OctreeBytes tree = OctreeBytes::binary();
  tree.size = "6";
  tree.body = std::string("\xC9\x80", 2) + std::string("\x10\x00", 2);
  const auto known = read_octree(tree.str(), "f");
  ASSERT_TRUE(known) << to_string(known.error());
  ASSERT_EQ(known->cells.size(), 4U);
  EXPECT_EQ(known->cells[0].log_odds, kBinaryFreeLogOdds);
  EXPECT_EQ(known->cells[1].log_odds, kBinaryOccupiedLogOdds);
  EXPECT_EQ(known->cells[1].index, (std::array<std::int16_t, 3>{0, -32768, -32768}));
  EXPECT_EQ(known->cells[2].index, (std::array<std::int16_t, 3>{0, 0, 0}));
  EXPECT_EQ(known->cells[3].level, 14);
  EXPECT_EQ(known->cells[3].index, (std::array<std::int16_t, 3>{0, 16384, -32768}));
}

TEST(OctreeReader, PassesOverColours) {
  OctreeBytes tree;
  tree.id = "ColorOcTree";
  tree.size = "2";
  const std::string colour = "\x01\xFF\x07";
  const auto coloured = [&](std::string node) { return node.insert(4, colour); };
  tree.body = coloured(octree_node(0.5F, 1)) + coloured(octree_node(0.25F, 0));
  const auto known = read_octree(tree.str(), "f");
  ASSERT_TRUE(known) << to_string(known.error());
  EXPECT_EQ(known->cells.at(0).log_odds, 0.25F);
}

TEST(OctreeReader, TakesEmptyTreesCommentsUnknownLinesAndOtherLineEnds) {
  for (OctreeBytes tree : {OctreeBytes(), OctreeBytes::binary()}) {
    tree.size = "0";
    tree.body = "";
    EXPECT_TRUE(read_octree(tree.str(), "f")) << tree.str();
  }
  const std::string odd = "# Octomap OcTree file\r\n# id Nothing\r\nstamp 5\r\nres 5e-2\r\nid 1\r\nsize 1\r\ndata\r\n" +
                          octree_node(1.0F, 0);
  const auto known = read_octree(odd, "f");
  ASSERT_TRUE(known) << to_string(known.error());
  EXPECT_EQ(known->resolution_m, 0.05);
}

TEST(OctreeReader, RefusesHeadersThatMakeNoSense) {
  const auto with = [](auto change) {
    OctreeBytes tree = full_octree();
    change(tree);
    return read_octree(tree.str(), "f");
  };
  for (const char* res : {"0", "nan", "-1", "inf", "1e-9", "1e4", "x", ""}) {
    expect_error(with([&](OctreeBytes& t) { t.res = res; }), ErrorCode::kParse, "res");
  }
  for (const char* size : {"1e18", "-1", "x", ""}) {
    expect_error(with([&](OctreeBytes& t) { t.size = size; }), ErrorCode::kParse, "size");
  }
  expect_error(with([](OctreeBytes& t) { t.id = ""; }), ErrorCode::kParse, "id");
  expect_error(with([](OctreeBytes& t) { t.id = "CountingOcTree"; }), ErrorCode::kUnsupported, "save it as an OcTree");
  expect_error(with([](OctreeBytes& t) { t.first_line = "ply"; }), ErrorCode::kParse, "# Octomap OcTree file");
  expect_error(read_octree("", "f"), ErrorCode::kTruncated, "empty");
  expect_error(read_octree(std::string("\3\0\0\0\x9A\x99", 6), "f"), ErrorCode::kUnsupported, "convert_octree");
}

TEST(OctreeReader, HoldsTheHeadersCountAgainstTheTree) {
  for (const char* size : {"17", "19", "1000000000000000000", "18446744073709551615"}) {
    OctreeBytes tree = full_octree();
    tree.size = size;
    kilter_testing::largest_allocation() = 0;
    EXPECT_FALSE(read_octree(tree.str(), "f")) << size;
    EXPECT_LE(kilter_testing::largest_allocation(), 4096U);
    tree = OctreeBytes::binary();
    tree.body = std::string("\xC9\x80\x10\x00", 4);
    tree.size = size;
    kilter_testing::largest_allocation() = 0;
    EXPECT_FALSE(read_octree(tree.str(), "f")) << size;
    EXPECT_LE(kilter_testing::largest_allocation(), 4096U);
  }
  OctreeBytes longer = full_octree();
  longer.body += "more";
  expect_error(read_octree(longer.str(), "f"), ErrorCode::kCountMismatch, "4 bytes more");
}

TEST(OctreeReader, RefusesBombsWithoutGoingDeep) {
  const std::string ones(200'000, '\xFF');
  for (const char* size : {"40000", "100000", "800001", "400001"}) {
    OctreeBytes tree = OctreeBytes::binary();
    tree.size = size;
    tree.body = ones;
    expect_error(read_octree(tree.str(), "f"), ErrorCode::kParse, "deeper than its 16 levels");
    tree = {};
    tree.size = "40000";
    tree.body = ones;
    expect_error(read_octree(tree.str(), "f"), ErrorCode::kParse, "deeper than its 16 levels");
  }
}

TEST(OctreeReader, RefusesNodesThatCannotBe) {
  OctreeBytes tree = OctreeBytes::binary();
  tree.size = "1";
  tree.body = std::string(2, '\0');
  expect_error(read_octree(tree.str(), "f"), ErrorCode::kParse, "no children");
  for (const float odd : {std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::infinity()}) {
    OctreeBytes full;
    full.size = "1";
    full.body = octree_node(odd, 0);
    expect_error(read_octree(full.str(), "f"), ErrorCode::kParse, "not a finite number");
  }
}

TEST(OctreeReader, GivesCentresOfOccupiedCells) {
  const OccupancyCells known = {0.5, {{{0, 0, 0}, 0, 1.0F}, {{2, -2, 4}, 1, 1.0F}, {{9, 9, 9}, 0, -1.0F}}};
  const PointCloud cloud = occupied_centres(known);
  ASSERT_EQ(cloud.points_m.size(), 2U);
  EXPECT_EQ(cloud.points_m[0], Eigen::Vector3f(0.25F, 0.25F, 0.25F));
  EXPECT_EQ(cloud.points_m[1], Eigen::Vector3f(1.5F, -0.5F, 2.5F));
}

TEST(OctreeReader, TellsTheResolutionFromTheHeaderAlone) {
  const kilter_testing::TempFolder folder;
  OctreeBytes tree = full_octree();
  tree.body.resize(3);
  const auto path = folder.write("a.ot", tree.str());
  EXPECT_EQ(read_octree_resolution_m(path).value(), 0.1);
  EXPECT_FALSE(read_octree_resolution_m(folder.path() / "none.ot"));
  EXPECT_FALSE(read_octree_file(path));
  EXPECT_TRUE(has_octree_name("a.OT"));
  EXPECT_FALSE(has_octree_name("a.pot.pcd"));
}

}  // namespace
}  // namespace kilter
