// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/occupancy/block_store.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "kilter/base/rng.h"
#include "kilter/occupancy/scan_marks.h"

namespace kilter {
namespace {

// One block under random marks, beside a float for each voxel.
void expect_the_log_odds_of_floats(const OccupancyOptions& options, double hits) {
  const LogOddsModel model(options);
  BlockStore store(model);
  std::array<float, kBlockVoxels> log_odds{};
  std::array<bool, kBlockVoxels> known{};
  Rng rng(1, 0);
  for (int scan = 0; scan < 40; ++scan) {
    std::array<std::uint8_t, kBlockVoxels> marks{};
    for (std::size_t i = 0; i < kBlockVoxels; ++i) {
      const double u = rng.uniform(0, 1);
      marks[i] = scan > 10 && u < hits ? ScanMarks::kHit : (u < 0.3 ? ScanMarks::kMiss : std::uint8_t{0});
      if (marks[i] == 0) continue;
      known[i] = true;
      log_odds[i] = marks[i] == ScanMarks::kHit ? model.after_hit(log_odds[i]) : model.after_miss(log_odds[i]);
    }
    store.apply({-3, 4, 5}, marks);
  }
  const BlockStore::Finished finished = store.finish();
  ASSERT_EQ(finished.blocks.size(), 1U);
  const VoxelBlock& block = finished.blocks.front();
  EXPECT_EQ(block.key, block_key({-3, 4, 5}));
  std::size_t next = 0;
  for (std::size_t i = 0; i < kBlockVoxels; ++i) {
    const bool occupied = (block.occupied[i / 64] >> (i % 64) & 1) != 0;
    const bool free = (block.free[i / 64] >> (i % 64) & 1) != 0;
    ASSERT_EQ(occupied, known[i] && model.is_occupied(log_odds[i])) << i;
    ASSERT_EQ(free, known[i] && !occupied && log_odds[i] < 0.0F) << i;
    if (occupied) {
      ASSERT_EQ(finished.log_odds[next++], log_odds[i]) << i;
    }
  }
  EXPECT_EQ(next, finished.log_odds.size());
  EXPECT_EQ(block.voxel_count, next);
}

TEST(BlockStore, HoldsTheLogOddsOfEveryVoxel) {
  expect_the_log_odds_of_floats({}, 0.0);  // free space only
  expect_the_log_odds_of_floats({}, 0.1);
  expect_the_log_odds_of_floats({.probability_miss = 0.4999, .clamping_min = 0.001}, 0.01);  // misses no byte can count
  expect_the_log_odds_of_floats({.probability_miss = 0.5}, 0.01);                            // misses that say nothing
  expect_the_log_odds_of_floats({.occupancy_threshold = 0.3}, 0.0);                          // occupied by misses
  expect_the_log_odds_of_floats({.occupancy_threshold = 0.9}, 0.1);                          // hit, but not enough
}

TEST(BlockStore, SortsBlocksByKey) {
  BlockStore store{LogOddsModel({})};
  std::array<std::uint8_t, kBlockVoxels> marks{};
  marks[0] = ScanMarks::kHit;
  for (const int x : {3, -7, 0}) store.apply({x, -x, 1}, marks);
  const BlockStore::Finished finished = store.finish();
  ASSERT_EQ(finished.blocks.size(), 3U);
  EXPECT_LT(finished.blocks[0].key, finished.blocks[1].key);
  EXPECT_LT(finished.blocks[1].key, finished.blocks[2].key);
  EXPECT_EQ(finished.blocks[2].first_voxel, 2U);
  EXPECT_TRUE(store.finish().blocks.empty());
}

}  // namespace
}  // namespace kilter
