// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Our trees against those of OctoMap's own library, both ways. Built only where liboctomap is there.
#include <gtest/gtest.h>
#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "kilter/base/rng.h"
#include "kilter/io/octree_reader.h"
#include "kilter/io/octree_writer.h"
#include "kilter/occupancy/map_builder.h"
#include "testing/octree_rows.h"

namespace kilter {
namespace {

using kilter_testing::rows_of;
using Row = kilter_testing::OctreeRow;

template <typename Tree>
std::vector<Row> rows_of(const Tree& tree) {
  std::vector<Row> rows;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    const octomap::OcTreeKey key = leaf.getIndexKey();
    rows.emplace_back(key[0] - 32768, key[1] - 32768, key[2] - 32768, 16 - static_cast<int>(leaf.getDepth()),
                      leaf->getLogOdds());
  }
  std::sort(rows.begin(), rows.end());
  return rows;
}

// Three scans of a noisy box from inside.
template <typename Tree>
Tree scanned_tree(double resolution_m) {
  Tree tree(resolution_m);
  Rng rng(3, 0);
  for (int scan = 0; scan < 3; ++scan) {
    octomap::Pointcloud cloud;
    for (int i = 0; i < 3000; ++i) {
      Eigen::Vector3d at(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
      at *= 4.0 / at.cwiseAbs().maxCoeff();
      cloud.push_back(static_cast<float>(at.x()), static_cast<float>(at.y()), static_cast<float>(at.z()));
    }
    tree.insertPointCloud(cloud, octomap::point3d(0.3F * static_cast<float>(scan), 0.1F, 0.2F));
  }
  tree.updateInnerOccupancy();
  tree.prune();
  return tree;
}

template <typename Tree>
std::string full_bytes(const Tree& tree) {
  std::ostringstream bytes;
  tree.write(bytes);
  return bytes.str();
}

TEST(OctomapOracle, WeReadTheirFullTrees) {
  const auto tree = scanned_tree<octomap::OcTree>(0.1);
  const auto known = read_octree(full_bytes(tree), "f");
  EXPECT_EQ(rows_of(known), rows_of(tree));
  EXPECT_EQ(known->resolution_m, tree.getResolution());
  EXPECT_GT(known->cells.size(), 10'000U);
}

TEST(OctomapOracle, WeReadTheirBinaryTrees) {
  auto tree = scanned_tree<octomap::OcTree>(0.15);
  std::ostringstream bytes;
  tree.writeBinary(bytes);
  octomap::OcTree again(0.15);
  std::istringstream stream(bytes.str());
  ASSERT_TRUE(again.readBinary(stream));
  EXPECT_EQ(rows_of(read_octree(bytes.str(), "f")), rows_of(again));
}

TEST(OctomapOracle, WeReadTheirColouredTrees) {
  auto tree = scanned_tree<octomap::ColorOcTree>(0.2);
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) leaf->setColor(1, 255, 128);
  EXPECT_EQ(rows_of(read_octree(full_bytes(tree), "f")), rows_of(tree));
}

TEST(OctomapOracle, WeReadTheirEmptyTrees) {
  octomap::OcTree tree(0.1);
  EXPECT_TRUE(rows_of(read_octree(full_bytes(tree), "f")).empty());
  std::ostringstream bytes;
  tree.writeBinary(bytes);
  EXPECT_TRUE(rows_of(read_octree(bytes.str(), "f")).empty());
}

VoxelMap scanned_map() {
  Rng rng(4, 0);
  MapBuilder builder({.resolution_m = 0.1});
  std::vector<Eigen::Vector3d> points_m;
  for (int i = 0; i < 4000; ++i) {
    const Eigen::Vector3d at(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
    points_m.emplace_back(at * (5.0 / at.cwiseAbs().maxCoeff()));
  }
  builder.insert_scan(points_m, Eigen::Vector3d(0.5, -0.25, 0.1));
  return builder.finish();
}

TEST(OctomapOracle, TheyReadOurFullTrees) {
  const VoxelMap map = scanned_map();
  const OccupancyCells cells = cells_from_map(map, -0.4F).value();
  const std::string bytes = octree_bytes(cells, OctreeFormat::kFull);
  std::istringstream stream(bytes);
  const std::unique_ptr<octomap::AbstractOcTree> read(octomap::AbstractOcTree::read(stream));
  const auto* tree = dynamic_cast<octomap::OcTree*>(read.get());
  ASSERT_NE(tree, nullptr);
  EXPECT_EQ(rows_of(*tree), rows_of(read_octree(bytes, "f")));
  // Cell by cell what the map says, and inner nodes as they would make them.
  for (const OccupancyCell& cell : cells.cells) {
    const Eigen::Vector3d at = voxel_centre({cell.index[0], cell.index[1], cell.index[2]}, 0.1);
    const octomap::OcTreeNode* node = tree->search(at.x(), at.y(), at.z());
    ASSERT_NE(node, nullptr);
    ASSERT_EQ(node->getLogOdds(), cell.log_odds);
    ASSERT_EQ(tree->isNodeOccupied(node), map.state(voxel_at(at, 0.1)) == CellState::kOccupied);
  }
  octomap::OcTree remade(*tree);
  remade.updateInnerOccupancy();
  remade.prune();
  EXPECT_EQ(full_bytes(remade), full_bytes(*tree));
}

TEST(OctomapOracle, TheyReadOurBinaryTrees) {
  const OccupancyCells cells = cells_from_map(scanned_map(), -0.4F).value();
  const std::string bytes = octree_bytes(cells, OctreeFormat::kBinary);
  octomap::OcTree tree(1.0);
  std::istringstream stream(bytes);
  ASSERT_TRUE(tree.readBinary(stream));  // it holds the header's count against the nodes
  EXPECT_EQ(rows_of(tree), rows_of(read_octree(bytes, "f")));
  EXPECT_EQ(tree.getResolution(), 0.1);
}

}  // namespace
}  // namespace kilter
