// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/octree_writer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "kilter/base/rng.h"
#include "kilter/io/octree_reader.h"
#include "testing/octree_bytes.h"
#include "testing/octree_rows.h"

namespace kilter {
namespace {

using kilter_testing::rows_of;
using Row = kilter_testing::OctreeRow;

OccupancyCells scattered_cells(int count) {
  Rng rng(11, 0);
  OccupancyCells known{0.05, {}};
  const auto index = [&] { return static_cast<std::int16_t>(static_cast<int>(rng.below(65536)) - 32768); };
  for (int i = 0; i < count; ++i) {
    known.cells.push_back({{index(), index(), index()}, 0, static_cast<float>(rng.uniform(-2.0, 3.5))});
  }
  return known;
}

TEST(OctreeWriter, WritesTheTreeWorkedOutByHand) {
  const OccupancyCells known = {0.1, {{{1, 0, 1}, 0, -0.4F}, {{0, 0, 0}, 0, 0.85F}}};
  const std::string bytes = octree_bytes(known, OctreeFormat::kFull);
  EXPECT_TRUE(bytes.ends_with("id OcTree\nsize 18\nres 0.1\ndata\n" + kilter_testing::full_octree().body));
}

TEST(OctreeWriter, ReaderGivesBackWhatWasWritten) {
  const OccupancyCells known = scattered_cells(3000);
  const auto again = read_octree(octree_bytes(known, OctreeFormat::kFull), "f");
  EXPECT_EQ(rows_of(again), rows_of(known));
  EXPECT_EQ(again->resolution_m, known.resolution_m);
  const auto binary = read_octree(octree_bytes(known, OctreeFormat::kBinary), "f");
  ASSERT_TRUE(binary);
  ASSERT_EQ(binary->cells.size(), known.cells.size());
  OccupancyCells expected = known;
  for (OccupancyCell& cell : expected.cells) {
    cell.log_odds = cell.log_odds >= 0.0F ? kBinaryOccupiedLogOdds : kBinaryFreeLogOdds;
  }
  EXPECT_EQ(rows_of(binary), rows_of(expected));
}

TEST(OctreeWriter, OrderOfCellsDoesNotMatter) {
  OccupancyCells known = scattered_cells(500);
  const std::string bytes = octree_bytes(known, OctreeFormat::kFull);
  std::reverse(known.cells.begin(), known.cells.end());
  EXPECT_EQ(octree_bytes(known, OctreeFormat::kFull), bytes);
}

TEST(OctreeWriter, PrunesWhatAgrees) {
  OccupancyCells known{0.1, {}};
  for (std::int16_t x = 0; x < 4; ++x) {
    for (std::int16_t y = 0; y < 4; ++y) {
      for (std::int16_t z = -4; z < 0; ++z) known.cells.push_back({{x, y, z}, 0, -0.4F});
    }
  }
  EXPECT_EQ(rows_of(read_octree(octree_bytes(known, OctreeFormat::kFull), "f")),
            (std::vector<Row>{{0, 0, -4, 2, -0.4F}}));
  known.cells[5].log_odds = -0.5F;
  EXPECT_EQ(read_octree(octree_bytes(known, OctreeFormat::kFull), "f")->cells.size(), 7U + 8U);
  EXPECT_EQ(read_octree(octree_bytes(known, OctreeFormat::kBinary), "f")->cells.size(), 1U);
}

TEST(OctreeWriter, LargerCellsStandWhereTheyOverlap) {
  const OccupancyCells known = {0.1, {{{0, 0, 0}, 0, 1.0F}, {{0, 0, 0}, 2, -1.0F}, {{3, 3, 3}, 0, 1.0F}}};
  EXPECT_EQ(rows_of(read_octree(octree_bytes(known, OctreeFormat::kFull), "f")),
            (std::vector<Row>{{0, 0, 0, 2, -1.0F}}));
}

TEST(OctreeWriter, WritesNothingAndEverything) {
  for (const OctreeFormat format : {OctreeFormat::kFull, OctreeFormat::kBinary}) {
    EXPECT_TRUE(rows_of(read_octree(octree_bytes({0.1, {}}, format), "f")).empty());
    const OccupancyCells all = {0.1, {{{-32768, -32768, -32768}, 16, -2.0F}}};
    EXPECT_EQ(rows_of(read_octree(octree_bytes(all, format), "f")).size(), format == OctreeFormat::kFull ? 1U : 8U);
  }
}

}  // namespace
}  // namespace kilter
