// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Our maps of scans against those of OctoMap's own library. Built only where liboctomap is there.
#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include <bit>
#include <cstdint>
#include <vector>

#include "kilter/base/rng.h"
#include "kilter/base/vector_path.h"
#include "kilter/occupancy/map_builder.h"

namespace kilter {
namespace {

// Returns all around, near and beyond `max_range_m`, some along an axis, some on borders of voxels.
std::vector<Eigen::Vector3d> ragged_scan(Rng& rng, const Eigen::Vector3d& origin_m, double max_range_m) {
  std::vector<Eigen::Vector3d> points_m;
  for (int i = 0; i < 1500; ++i) {
    Eigen::Vector3d direction(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-0.3, 0.3));
    if (i % 50 == 0) direction = Eigen::Vector3d::Unit(i / 50 % 3) * (i % 100 == 0 ? 1.0 : -1.0);
    if (i % 51 == 0) direction[i / 51 % 3] = 0.0;
    Eigen::Vector3d point_m = origin_m + direction.normalized() * rng.uniform(0.01, 1.2 * max_range_m);
    if (i % 7 == 0) point_m = (point_m * 10.0).array().round() / 10.0;
    points_m.emplace_back(point_m.cast<float>().cast<double>());
  }
  return points_m;
}

void expect_the_cells_of(const octomap::OcTree& tree, const VoxelMap& map) {
  std::size_t free_count = 0;
  std::size_t occupied_count = 0;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    const octomap::OcTreeKey key = leaf.getIndexKey();
    const VoxelIndex at(key[0] - 32768, key[1] - 32768, key[2] - 32768);
    const bool occupied = tree.isNodeOccupied(*leaf);
    ASSERT_EQ(map.state(at), occupied ? CellState::kOccupied : CellState::kFree) << at.transpose();
    ++(occupied ? occupied_count : free_count);
    if (occupied) {
      ASSERT_EQ(map.voxels().log_odds[static_cast<std::size_t>(map.find_voxel(at))], leaf->getLogOdds());
    }
  }
  std::size_t our_free_count = 0;
  for (const VoxelBlock& block : map.blocks()) {
    for (const std::uint64_t layer : block.free) our_free_count += static_cast<std::size_t>(std::popcount(layer));
  }
  EXPECT_EQ(map.voxels().size(), occupied_count);
  EXPECT_EQ(our_free_count, free_count);
  EXPECT_GT(occupied_count, 1'000U);
  EXPECT_GT(free_count, 100'000U);
}

void expect_the_map_of_octomap(double resolution_m, double max_range_m, std::uint64_t seed) {
  octomap::OcTree tree(resolution_m);
  std::vector<MapBuilder> builders;
  for (const VectorPath path : vector_paths()) {
    builders.emplace_back(
        OccupancyOptions{.resolution_m = resolution_m, .min_range_m = 0.0, .max_range_m = max_range_m}, path);
  }
  Rng rng(seed, 0);
  for (int scan = 0; scan < 8; ++scan) {
    Eigen::Vector3f origin_m = Eigen::Vector3f::Zero();
    if (scan > 0) origin_m = Eigen::Vector3d(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(0, 0.2)).cast<float>();
    const auto points_m = ragged_scan(rng, origin_m.cast<double>(), max_range_m);
    octomap::Pointcloud cloud;
    for (const Eigen::Vector3d& p : points_m) {
      cloud.push_back(static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()));
    }
    tree.insertPointCloud(cloud, {origin_m.x(), origin_m.y(), origin_m.z()}, max_range_m, true);
    for (MapBuilder& builder : builders) builder.insert_scan(points_m, origin_m.cast<double>());
  }
  for (std::size_t path = 0; path < builders.size(); ++path) {
    SCOPED_TRACE(testing::Message() << "resolution " << resolution_m << ", path " << path);
    expect_the_cells_of(tree, builders[path].finish());
  }
}

TEST(OctomapMapOracle, OurMapOfScansIsTheirsCellByCell) {
  expect_the_map_of_octomap(0.1, 10.0, 1);
  expect_the_map_of_octomap(0.15, 15.0, 2);
  expect_the_map_of_octomap(0.07, 5.0, 3);
}

}  // namespace
}  // namespace kilter
