// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/occupancy/hit_sums.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <map>
#include <numeric>
#include <vector>

#include "kilter/base/rng.h"

namespace kilter {
namespace {

constexpr double kResolution_m = 0.1;

// Scans of a room of so many voxels an axis; every other one has no origin.
struct Scans {
  std::vector<std::vector<HitSums::Hit>> hits;
  std::vector<Eigen::Vector3f> origins_m;
};

Scans scans_of(int count, double half_m) {
  Rng rng(11, 0);
  Scans scans;
  for (int scan = 0; scan < count; ++scan) {
    scans.origins_m.push_back(Eigen::Vector3d(rng.uniform(-1, 1), rng.uniform(-1, 1), 0.0).cast<float>());
    auto& hits = scans.hits.emplace_back();
    for (int i = 0; i < 500; ++i) {
      const Eigen::Vector3d at_m(rng.uniform(-half_m, half_m), rng.uniform(-half_m, half_m), rng.uniform(0, half_m));
      hits.push_back({at_m.cast<float>(), scan % 2 == 0 ? static_cast<std::uint32_t>(scan) : HitSums::kNoOrigin});
    }
  }
  return scans;
}

HitSums sums_of(const Scans& scans, std::size_t many_hits) {
  HitSums sums(kResolution_m, many_hits);
  for (std::size_t i = 0; i < scans.hits.size(); ++i) {
    for (const HitSums::Hit& hit : scans.hits[i]) sums.add(hit);
    sums.sum_up_if_many(std::span(scans.origins_m).first(i + 1));
  }
  return sums;
}

// Blocks with every voxel that was hit and lies on this side of z.
std::vector<VoxelBlock> blocks_of(const Scans& scans, int below_z) {
  std::map<std::uint64_t, VoxelBlock> blocks;
  for (const auto& scan : scans.hits) {
    for (const HitSums::Hit& hit : scan) {
      const VoxelIndex voxel = voxel_at(hit.point_m.cast<double>(), kResolution_m);
      VoxelBlock& block = blocks[block_key(block_of(voxel))];
      const int bit = bit_of(voxel);
      if (voxel.z() < below_z) block.occupied[static_cast<std::size_t>(bit >> 6)] |= std::uint64_t{1} << (bit & 63);
    }
  }
  std::vector<VoxelBlock> sorted;
  std::uint32_t first = 0;
  for (auto& [key, block] : blocks) {
    block.key = key;
    block.first_voxel = first;
    for (const std::uint64_t bits : block.occupied)
      block.voxel_count += static_cast<std::uint32_t>(std::popcount(bits));
    first += block.voxel_count;
    sorted.push_back(block);
  }
  return sorted;
}

TEST(HitSums, HaveTheSameBitsWhetherHitsAreKeptOrSummed) {
  for (const double half_m : {0.3, 1.0, 20.0}) {
    const Scans scans = scans_of(60, half_m);
    const std::vector<VoxelBlock> blocks = blocks_of(scans, 3);
    const SurfaceVoxels kept = sums_of(scans, 1'000'000).summarise(blocks, scans.origins_m);
    ASSERT_GT(kept.size(), 50U);
    for (const std::size_t many_hits : {1U, 1000U, 7000U, 29'999U}) {
      const SurfaceVoxels summed = sums_of(scans, many_hits).summarise(blocks, scans.origins_m);
      EXPECT_EQ(summed.centroids_m, kept.centroids_m);
      EXPECT_EQ(summed.normals, kept.normals);
      EXPECT_EQ(summed.seen_at, kept.seen_at);
      EXPECT_EQ(summed.hits, kept.hits);
    }
  }
}

TEST(HitSums, CountTheHitsOfEachVoxel) {
  const Scans scans = scans_of(60, 0.3);
  std::size_t below = 0;
  for (const auto& scan : scans.hits) {
    for (const HitSums::Hit& hit : scan) {
      below += voxel_at(hit.point_m.cast<double>(), kResolution_m).z() < 2 ? 1 : 0;
    }
  }
  const SurfaceVoxels voxels = sums_of(scans, 1000).summarise(blocks_of(scans, 2), scans.origins_m);
  ASSERT_EQ(voxels.hits.size(), 72U);
  EXPECT_EQ(std::accumulate(voxels.hits.begin(), voxels.hits.end(), std::size_t{0}), below);
}

TEST(HitSums, CountNoMoreThanACounterHolds) {
  Scans scans = scans_of(1, 0.05);
  scans.hits[0].assign(70'000, HitSums::Hit{{0.01F, 0.01F, 0.01F}, 0});
  const SurfaceVoxels voxels = sums_of(scans, 1'000'000).summarise(blocks_of(scans, 1), scans.origins_m);
  ASSERT_EQ(voxels.size(), 1U);
  EXPECT_EQ(voxels.hits[0], 65'535);
}

TEST(HitSums, TakeNoMoreThanTheirVoxelsWhereARobotStandsStill) {
  const std::size_t few = sums_of(scans_of(100, 0.5), 5000).held_bytes();
  const std::size_t many = sums_of(scans_of(1000, 0.5), 5000).held_bytes();
  EXPECT_LT(many, few + 5500 * sizeof(HitSums::Hit));
}

TEST(HitSums, KeepHitsThatFallIntoAsManyVoxels) {
  const Scans scans = scans_of(100, 200.0);
  EXPECT_LT(sums_of(scans, 5000).held_bytes(), 50'000 * sizeof(HitSums::Hit) * 3 / 2);
}

}  // namespace
}  // namespace kilter
