// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/occupancy/occupancy_cells.h"

#include <gtest/gtest.h>

#include <cmath>

#include "kilter/base/rng.h"
#include "kilter/occupancy/map_builder.h"

namespace kilter {
namespace {

constexpr float kFree = -2.0F;
constexpr float kSurface = 1.5F;

OccupancyCell cell(int x, int y, int z, int level, float log_odds) {
  return {{static_cast<std::int16_t>(x), static_cast<std::int16_t>(y), static_cast<std::int16_t>(z)},
          static_cast<std::uint8_t>(level),
          log_odds};
}

VoxelMap map_of(double file_resolution_m, std::vector<OccupancyCell> cells, double resolution_m = 0.1) {
  auto map = map_from_cells({file_resolution_m, std::move(cells)}, {.resolution_m = resolution_m});
  if (!map) ADD_FAILURE() << to_string(map.error());
  return map ? *std::move(map) : VoxelMap();
}

std::size_t free_voxels(const VoxelMap& map) {
  std::size_t count = 0;
  for (const VoxelBlock& block : map.blocks()) {
    for (const std::uint64_t layer : block.free) count += static_cast<std::size_t>(std::popcount(layer));
  }
  return count;
}

TEST(OccupancyCells, AreVoxelsAtEqualResolution) {
  const VoxelMap map = map_of(0.1, {cell(-1, 2, 3, 0, kSurface), cell(0, 2, 3, 0, kFree), cell(-9, 2, 3, 0, 0.5F)});
  ASSERT_EQ(map.voxels().size(), 2U);
  EXPECT_EQ(map.state({-1, 2, 3}), CellState::kOccupied);
  EXPECT_EQ(map.state({-9, 2, 3}), CellState::kOccupied);
  EXPECT_EQ(map.state({0, 2, 3}), CellState::kFree);
  EXPECT_EQ(map.state({1, 2, 3}), CellState::kUnknown);
  const auto voxel = static_cast<std::size_t>(map.find_voxel({-1, 2, 3}));
  EXPECT_EQ(map.voxels().log_odds[voxel], kSurface);
  EXPECT_EQ(map.voxels().hits, std::vector<std::uint16_t>({1, 1})) << "nobody knows";
  EXPECT_TRUE(map.voxels().centroids_m[voxel].isApprox(Eigen::Vector3f(-0.05F, 0.25F, 0.35F)));
  EXPECT_TRUE(map.has_free_space());
}

TEST(OccupancyCells, SayHowFarTheirCentresMayBeOff) {
  EXPECT_EQ(map_of(0.1, {cell(0, 0, 0, 0, kSurface), cell(2, 0, 0, 1, kSurface)}).cell_m(), 0.1);
  EXPECT_EQ(map_of(0.05, {cell(0, 0, 0, 0, kSurface)}).cell_m(), 0.1) << "a voxel's centre, whatever is in it";
  EXPECT_EQ(map_of(0.5, {cell(0, 0, 0, 0, kSurface), cell(1, 0, 0, 0, kFree)}).cell_m(), 0.5);
  EXPECT_EQ(map_of(0.1, {cell(0, 0, 0, 2, kSurface), cell(4, 0, 0, 0, kFree)}).cell_m(), 0.4) << "cut off at a depth";
  MapBuilder builder({.resolution_m = 0.1});
  builder.insert_points(std::vector<Eigen::Vector3d>{{0.05, 0.05, 0.05}});
  EXPECT_EQ(builder.finish().cell_m(), 0.0);
}

TEST(OccupancyCells, OfAPrunedLeafFillItsCube) {
  const VoxelMap map = map_of(0.1, {cell(-16, 0, 16, 4, kFree), cell(0, 0, 0, 1, kSurface)});
  EXPECT_EQ(free_voxels(map), 4096U);
  EXPECT_EQ(map.voxels().size(), 8U);
  EXPECT_EQ(map.state({-16, 0, 16}), CellState::kFree);
  EXPECT_EQ(map.state({-1, 15, 31}), CellState::kFree);
  EXPECT_EQ(map.state({1, 1, 1}), CellState::kOccupied);
  EXPECT_EQ(map.state({0, 16, 16}), CellState::kUnknown);
}

TEST(OccupancyCells, OfACoarserFileAreTheVoxelsWhoseCentreTheyHold) {
  const VoxelMap map = map_of(0.25, {cell(0, 0, 0, 0, kSurface)});  // centres at 0.05, 0.15 inside, 0.25 not
  EXPECT_EQ(map.voxels().size(), 8U);
  EXPECT_EQ(map.state({1, 1, 1}), CellState::kOccupied);
  EXPECT_EQ(map.state({2, 1, 1}), CellState::kUnknown);
}

TEST(OccupancyCells, OfAFinerFileGiveTheMostOccupied) {
  const VoxelMap map = map_of(0.05, {cell(0, 0, 0, 0, kFree), cell(1, 0, 0, 0, 0.25F), cell(1, 1, 0, 0, kSurface),
                                     cell(2, 0, 0, 0, kFree), cell(-1, 0, 0, 0, kFree)});
  ASSERT_EQ(map.voxels().size(), 1U);
  EXPECT_EQ(map.voxels().log_odds[0], kSurface);
  EXPECT_EQ(map.state({0, 0, 0}), CellState::kOccupied);
  EXPECT_EQ(map.state({1, 0, 0}), CellState::kFree);
  EXPECT_EQ(map.state({-1, 0, 0}), CellState::kFree);
}

TEST(OccupancyCells, AreOccupiedFromTheThresholdOn) {
  const OccupancyCells known = {0.1, {cell(0, 0, 0, 0, 0.1F), cell(1, 0, 0, 0, -0.1F), cell(2, 0, 0, 0, 0.5F)}};
  const auto map = map_from_cells(known, {.occupancy_threshold = 0.6});
  EXPECT_EQ(map->state({0, 0, 0}), CellState::kUnknown) << "more hit than missed is not free";
  EXPECT_EQ(map->state({1, 0, 0}), CellState::kFree);
  EXPECT_EQ(map->state({2, 0, 0}), CellState::kOccupied);
}

TEST(OccupancyCells, PointNormalsToTheFreeSide) {
  std::vector<OccupancyCell> cells;
  for (int x = -10; x < 10; ++x) {
    for (int y = -10; y < 10; ++y) {
      cells.push_back(cell(x, y, 5, 0, kSurface));
      for (int z = 0; z < 5; ++z) cells.push_back(cell(x, y, z, 0, kFree));
    }
  }
  const VoxelMap map = map_of(0.1, cells);
  ASSERT_EQ(map.voxels().size(), 400U);
  for (const Eigen::Vector3f& normal : map.voxels().normals) EXPECT_NEAR(normal.z(), -1.0F, 1e-4F);
}

TEST(OccupancyCells, GiveAMapBack) {
  Rng rng(5, 0);
  MapBuilder builder({.resolution_m = 0.1, .min_range_m = 0.0});
  std::vector<Eigen::Vector3d> points_m;
  for (int i = 0; i < 300; ++i) points_m.emplace_back(rng.uniform(-4, 4), rng.uniform(-4, 4), rng.uniform(-1, 1));
  builder.insert_scan(points_m, Eigen::Vector3d(0.05, 0.05, 0.05));
  const VoxelMap map = builder.finish();
  const auto cells = cells_from_map(map, -0.4F);
  ASSERT_TRUE(cells);
  const VoxelMap again = map_of(cells->resolution_m, cells->cells);
  EXPECT_EQ(again.indices(), map.indices());
  EXPECT_EQ(again.voxels().log_odds, map.voxels().log_odds);
  ASSERT_EQ(again.blocks().size(), map.blocks().size());
  for (std::size_t i = 0; i < map.blocks().size(); ++i) EXPECT_EQ(again.blocks()[i].free, map.blocks()[i].free);
}

TEST(OccupancyCells, TooManyForAMapAreRefused) {
  for (const float log_odds : {kFree, kSurface}) {
    const auto all = map_from_cells({0.1, {cell(-32768, -32768, -32768, 16, log_odds)}}, {});
    ASSERT_FALSE(all);
    EXPECT_EQ(all.error().code, ErrorCode::kUnsupported);
    EXPECT_NE(all.error().message.find("6553.6 m"), std::string::npos) << all.error().message;
  }
  const auto far = map_from_cells({1000.0, {cell(32767, 0, 0, 0, kFree)}}, {});
  ASSERT_FALSE(far);
  EXPECT_EQ(far.error().code, ErrorCode::kUnsupported);
}

TEST(OccupancyCells, MayBeLargeWhereManyBearItOut) {
  // 128 voxels an edge are 2^21 occupied ones: too many for one cell, as free space still little.
  EXPECT_FALSE(map_from_cells({0.1, {cell(0, 0, 0, 7, kSurface)}}, {}));
  EXPECT_TRUE(map_from_cells({0.1, {cell(0, 0, 0, 7, kFree)}}, {}));
  EXPECT_FALSE(map_from_cells({0.1, {cell(0, 0, 0, 10, kFree)}}, {}));
}

TEST(OccupancyCells, OfFarVoxelsDoNotFit) {
  EXPECT_TRUE(cell_of_voxel({-32768, 32767, 0}, 0.1, 0.0F));
  EXPECT_FALSE(cell_of_voxel({-32769, 0, 0}, 0.1, 0.0F));
  EXPECT_FALSE(cell_of_voxel({0, 0, 32768}, 0.1, 0.0F));
}

TEST(OccupancyCells, NoneAreAnEmptyMap) {
  const VoxelMap map = map_of(0.1, {});
  EXPECT_EQ(map.voxels().size(), 0U);
  EXPECT_FALSE(map.has_free_space());
}

}  // namespace
}  // namespace kilter
