// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/occupancy/voxel_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "kilter/base/rng.h"
#include "kilter/occupancy/map_builder.h"

namespace kilter {
namespace {

VoxelMap random_map(std::uint64_t seed, double spread_m, int points) {
  Rng rng(seed, 0);
  std::vector<Eigen::Vector3d> cloud(static_cast<std::size_t>(points));
  for (Eigen::Vector3d& p : cloud) {
    p = {rng.uniform(-spread_m, spread_m), rng.uniform(-spread_m, spread_m), rng.uniform(-spread_m, spread_m)};
  }
  MapBuilder builder({.resolution_m = 0.1});
  builder.insert_points(cloud);
  return builder.finish();
}

TEST(VoxelIndex, RoundsDownOnBothSidesOfZero) {
  for (const double value : {-1e6, -7.25, -7.0, -1.0, -1e-300, -0.0, 0.0, 1e-300, 0.999, 1.0, 7.0, 7.25, 1e6}) {
    EXPECT_EQ(whole_below(value), static_cast<int>(std::floor(value))) << value;
  }
  EXPECT_EQ(whole_below(std::nextafter(-3.0, -4.0)), -4);
  EXPECT_EQ(whole_below(std::nextafter(3.0, 2.0)), 2);
}

// Keys of blocks repeat after 2^21 blocks; what is found by them must not.
TEST(VoxelMap, KnowsNothingBeyondItsOwnBlocks) {
  for (const double spread_m : {2.0, 3000.0}) {  // with a table of blocks, and with a hash over their keys
    const VoxelMap map = random_map(3, spread_m, 200);
    const VoxelIndex voxel = map.indices().front();
    EXPECT_EQ(map.state(voxel), CellState::kOccupied);
    for (int axis = 0; axis < 3; ++axis) {
      const VoxelIndex far = voxel + VoxelIndex(VoxelIndex::Unit(axis) * (1 << 24));
      EXPECT_EQ(map.state(far), CellState::kUnknown);
      EXPECT_EQ(map.find_voxel(far), -1);
    }
  }
}

TEST(VoxelIndex, BlockKeysSortByZThenYThenXAndReadBack) {
  const Eigen::Vector3i low(-5, 3, -1);
  EXPECT_EQ(block_of_key(block_key(low)), low);
  EXPECT_LT(block_key({5, 5, -1}), block_key({-5, -5, 0}));
  EXPECT_LT(block_key({5, -1, 0}), block_key({-5, 0, 0}));
  EXPECT_EQ(block_of(VoxelIndex(-1, 8, 7)), Eigen::Vector3i(-1, 1, 0));
  EXPECT_EQ(voxel_of({-1, 1, 0}, bit_of({-1, 8, 7})), VoxelIndex(-1, 8, 7));
}

TEST(BlockIndex, DenseAndHashedTablesAnswerAlike) {
  std::set<std::uint64_t> keys;
  Rng rng(5, 0);
  for (int i = 0; i < 300; ++i) {
    keys.insert(block_key(Eigen::Vector3i(static_cast<int>(rng.below(4000)), static_cast<int>(rng.below(4000)),
                                          static_cast<int>(rng.below(4000)))));
  }
  const std::vector<std::uint64_t> sorted(keys.begin(), keys.end());
  const BlockIndex hashed(sorted);
  const BlockIndex dense(std::vector<std::uint64_t>{sorted.front()});
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    EXPECT_EQ(hashed.find(block_of_key(sorted[i])), static_cast<std::int32_t>(i));
    EXPECT_EQ(dense.find(block_of_key(sorted[i])), i == 0 ? 0 : BlockIndex::kNone);
  }
  EXPECT_EQ(hashed.find({-1, -1, -1}), BlockIndex::kNone);
  EXPECT_EQ(BlockIndex().find({0, 0, 0}), BlockIndex::kNone);
}

TEST(VoxelMap, FindsEveryVoxelByItsIndex) {
  const VoxelMap map = random_map(1, 2.0, 3000);
  ASSERT_GT(map.voxels().size(), 1000U);
  for (std::size_t i = 0; i < map.indices().size(); ++i) {
    EXPECT_EQ(map.find_voxel(map.indices()[i]), static_cast<std::int64_t>(i));
    EXPECT_EQ(map.state(map.indices()[i]), CellState::kOccupied);
  }
  EXPECT_EQ(map.find_voxel({1000, 1000, 1000}), -1);
  EXPECT_EQ(map.state({1000, 1000, 1000}), CellState::kUnknown);
}

TEST(VoxelMap, BoxVisitsExactlyTheVoxelsInside) {
  const VoxelMap map = random_map(2, 1.0, 2000);
  for (const VoxelIndex& reach :
       {VoxelIndex(0, 0, 0), VoxelIndex(1, 1, 1), VoxelIndex(4, 0, 9), VoxelIndex(2, 5, 1), VoxelIndex(9, 9, 9)}) {
    for (const VoxelIndex& low : {VoxelIndex(0, 0, 0), VoxelIndex(-3, 7, 8), VoxelIndex(-9, -10, 2)}) {
      const VoxelIndex high = low + reach;
      std::set<std::uint32_t> seen;
      map.visit_box(low, high, [&](std::uint32_t i) { EXPECT_TRUE(seen.insert(i).second); });
      std::set<std::uint32_t> expected;
      for (std::size_t i = 0; i < map.indices().size(); ++i) {
        const VoxelIndex& index = map.indices()[i];
        if ((index - low).minCoeff() >= 0 && (high - index).minCoeff() >= 0)
          expected.insert(static_cast<std::uint32_t>(i));
      }
      EXPECT_EQ(seen, expected);
    }
  }
}

TEST(VoxelMap, EmptyMapHasNoVoxelsAndAnEmptyBox) {
  const VoxelMap map = MapBuilder({.resolution_m = 0.1}).finish();
  EXPECT_EQ(map.voxels().size(), 0U);
  EXPECT_TRUE(map.bounds_m().isEmpty());
  EXPECT_EQ(map.state({0, 0, 0}), CellState::kUnknown);
}

}  // namespace
}  // namespace kilter
