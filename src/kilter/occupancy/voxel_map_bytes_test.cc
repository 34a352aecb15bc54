// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/occupancy/voxel_map_bytes.h"

#include <gtest/gtest.h>

#include "kilter/occupancy/map_builder.h"
#include "kilter/occupancy/occupancy_cells.h"

namespace kilter {
namespace {

VoxelMap wall_seen_from(const Eigen::Vector3d& origin_m) {
  std::vector<Eigen::Vector3d> points;
  for (int y = 0; y < 30; ++y) {
    for (int z = 0; z < 20; ++z) points.emplace_back(3.02 + 0.01 * y, 0.11 * y, 0.1 * z + 0.04);
  }
  MapBuilder builder({.resolution_m = 0.1});
  builder.insert_scan(points, origin_m);
  return builder.finish();
}

TEST(VoxelMapBytes, BringTheSameMapBack) {
  const VoxelMap map = wall_seen_from({0.5, 0.5, 1.0});
  const std::optional<VoxelMap> again = map_of_bytes(bytes_of_map(map));
  ASSERT_TRUE(again.has_value());
  EXPECT_EQ(bytes_of_map(*again), bytes_of_map(map));
  EXPECT_EQ(again->voxels().centroids_m, map.voxels().centroids_m);
  EXPECT_EQ(again->voxels().normals, map.voxels().normals);
  EXPECT_EQ(again->voxels().hits, map.voxels().hits);
  EXPECT_EQ(again->indices(), map.indices());
  EXPECT_EQ(again->bounds_m().min(), map.bounds_m().min());
  EXPECT_EQ(again->bytes(), map.bytes());
  EXPECT_EQ(again->has_free_space(), map.has_free_space());
}

TEST(VoxelMapBytes, KeepWhatCentroidsAreTheCentresOf) {
  EXPECT_EQ(map_of_bytes(bytes_of_map(wall_seen_from({0.5, 0.5, 1.0})))->cell_m(), 0.0);
  const Expected<VoxelMap> map = map_from_cells({0.4, {{{1, 2, 3}, 0, 1.5F}}}, {.resolution_m = 0.1});
  ASSERT_TRUE(map.has_value());
  EXPECT_EQ(map_of_bytes(bytes_of_map(*map))->cell_m(), 0.4);
}

TEST(VoxelMapBytes, HoldEmptyMapsToo) {
  const std::optional<VoxelMap> again = map_of_bytes(bytes_of_map(MapBuilder({.resolution_m = 0.2}).finish()));
  ASSERT_TRUE(again.has_value());
  EXPECT_EQ(again->voxels().size(), 0U);
  EXPECT_EQ(again->resolution_m(), 0.2);
}

TEST(VoxelMapBytes, AreRefusedOnceAnyOfThemChanged) {
  const std::vector<std::byte> bytes = bytes_of_map(wall_seen_from({0.5, 0.5, 1.0}));
  for (const std::size_t size : {std::size_t{0}, std::size_t{20}, bytes.size() - 1}) {
    EXPECT_FALSE(map_of_bytes(std::span(bytes).first(size)).has_value()) << size;
  }
  // The head, and places all over the columns.
  for (std::size_t at = 0; at < bytes.size(); at += at < 48 ? 8 : 997) {
    std::vector<std::byte> damaged = bytes;
    damaged[at] ^= std::byte{4};
    EXPECT_FALSE(map_of_bytes(damaged).has_value()) << at;
  }
}

}  // namespace
}  // namespace kilter
