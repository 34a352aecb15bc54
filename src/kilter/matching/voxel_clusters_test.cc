// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/voxel_clusters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "kilter/base/rng.h"
#include "kilter/occupancy/map_builder.h"

namespace kilter {
namespace {

// Points anywhere in boxes around some middles.
VoxelMap clouds(const std::vector<Eigen::Vector3d>& middles_m, int points, std::uint64_t seed) {
  Rng rng(seed, 0);
  std::vector<Eigen::Vector3d> cloud;
  for (int i = 0; i < points; ++i) {
    const Eigen::Vector3d& middle_m = middles_m[static_cast<std::size_t>(i) % middles_m.size()];
    const double x_m = rng.uniform(-6.0, 6.0);
    const double y_m = rng.uniform(-3.0, 3.0);
    cloud.push_back(middle_m + Eigen::Vector3d(x_m, y_m, rng.uniform(-1.5, 1.5)));
  }
  MapBuilder builder({.resolution_m = 0.1});
  builder.insert_points(cloud);
  return builder.finish();
}

// The last one is so wide that a table of its rows would be larger than what it holds.
std::vector<VoxelMap> maps() {
  std::vector<VoxelMap> made;
  made.push_back(clouds({{0, 0, 0}}, 20000, 1));
  made.push_back(clouds({{0, 0, 0}}, 300, 2));
  made.push_back(clouds({{0.4, 0.4, 0.4}, {30, -20, 5}}, 5000, 3));
  made.push_back(clouds({{0, 0, 0}, {9000, 7000, 800}, {-3000, 7000, 0}}, 3000, 4));
  return made;
}

using Numbers = std::set<std::int32_t>;

Numbers voxels_of(const VoxelClusters& clusters, const VoxelClusters::Range& range) {
  Numbers numbers;
  for (std::uint32_t k = range.first; k < range.end; ++k) {
    const Cluster cluster = clusters.boxes()[k];
    for (std::uint32_t i = cluster.first; i < cluster.end; ++i) numbers.insert(static_cast<std::int32_t>(i));
  }
  return numbers;
}

TEST(VoxelClusters, EveryVoxelIsInAClusterOfItsBlockWhoseBoxIsTight) {
  for (const VoxelMap& map : maps()) {
    for (const VoxelPosition position : {VoxelPosition::kCentre, VoxelPosition::kCentroid}) {
      const VoxelClusters clusters(map, position);
      std::uint32_t next = 0;
      for (std::uint32_t k = 0; k < clusters.boxes().size(); ++k) {
        const Cluster cluster = clusters.boxes()[k];
        ASSERT_EQ(cluster.first, next);
        ASSERT_LT(cluster.first, cluster.end);
        next = cluster.end;
        Eigen::AlignedBox3f box_m;
        const ClusteredPoints& points = clusters.points();
        ASSERT_LE(cluster.end - cluster.first, kMostLanes);
        const Eigen::Vector3i block = block_of(map.indices()[cluster.first]);
        for (std::uint32_t i = cluster.first; i < cluster.end; ++i) {
          ASSERT_EQ(block_of(map.indices()[i]), block);
          const Eigen::Vector3f at_m(points.x[i], points.y[i], points.z[i]);
          ASSERT_EQ(at_m, voxel_position_m(map, i, position).cast<float>());
          box_m.extend(at_m);
        }
        for (int axis = 0; axis < 3; ++axis) {
          ASSERT_EQ(cluster.low_m[static_cast<std::size_t>(axis)], box_m.min()[axis]);
          ASSERT_EQ(cluster.high_m[static_cast<std::size_t>(axis)], box_m.max()[axis]);
        }
      }
      EXPECT_EQ(next, map.voxels().size());
    }
  }
}

TEST(VoxelClusters, ARowHoldsTheVoxelsOfItsBlocks) {
  for (const VoxelMap& map : maps()) {
    const VoxelClusters clusters(map, VoxelPosition::kCentroid);
    Rng rng(7, 0);
    const std::span<const VoxelClusters::Block> blocks = clusters.blocks();
    int found = 0;
    for (int k = 0; k < 3000; ++k) {
      // Near some block, so that what lies beside the map is asked for as well.
      const Eigen::Vector3i near = block_of_key(blocks[rng.bits() % blocks.size()].key);
      const auto off = [&](std::uint64_t most) { return static_cast<int>(rng.bits() % (2 * most + 1) - most); };
      const int x_first = near.x() + off(20);
      const int x_end = x_first + static_cast<int>(rng.bits() % 24);
      const int y = near.y() + off(2);
      const int z = near.z() + off(1);
      Numbers expected;
      for (int x = x_first; x < x_end; ++x) {
        const std::int32_t number = map.find_block({x, y, z});
        if (number == BlockIndex::kNone) continue;
        const VoxelBlock& block = map.blocks()[static_cast<std::size_t>(number)];
        for (std::uint32_t i = 0; i < block.voxel_count; ++i) {
          expected.insert(static_cast<std::int32_t>(block.first_voxel + i));
        }
      }
      found += expected.empty() ? 0 : 1;
      ASSERT_EQ(voxels_of(clusters, clusters.in_row(x_first, x_end, y, z)), expected)
          << "blocks " << x_first << " to " << x_end << " of row " << y << ", " << z;
    }
    EXPECT_GT(found, 100);
  }
}

TEST(VoxelClusters, AnEmptyMapHasNone) {
  const VoxelClusters clusters(MapBuilder({.resolution_m = 0.1}).finish(), VoxelPosition::kCentroid);
  EXPECT_EQ(clusters.boxes().size(), 0);
  EXPECT_TRUE(voxels_of(clusters, clusters.in_row(-5, 5, 0, 0)).empty());
}

}  // namespace
}  // namespace kilter
