// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kilter/matching/scan_clusters.h"
#include "kilter/occupancy/voxel_map.h"

namespace kilter {

/// Which point stands for a voxel.
enum class VoxelPosition {
  kCentre,    ///< the middle of the lattice cell, as in the seed
  kCentroid,  ///< the mean of the hits inside
};

/// Position of occupied voxel i in the map's frame. [m]
[[nodiscard]] inline Eigen::Vector3d voxel_position_m(const VoxelMap& map, std::size_t i, VoxelPosition position) {
  if (position == VoxelPosition::kCentroid) return map.voxels().centroids_m[i].cast<double>();
  return voxel_centre(map.indices()[i], map.resolution_m());
}

/// The occupied voxels of a map, in its order, in clusters with the boxes around their points: up to sixteen of a block
/// that follow each other, which is a strip of a floor or a wall. Blocks of one row stand one after the other.
/// Immutable.
class VoxelClusters {
 public:
  /// Numbers of clusters one after the other.
  struct Range {
    std::uint32_t first = 0;
    std::uint32_t end = 0;
  };
  /// A block that holds occupied voxels.
  struct Block {
    std::uint64_t key = 0;
    Range clusters;
  };

  /// O(voxels). Nothing of the map is kept.
  VoxelClusters(const VoxelMap& map, VoxelPosition position);

  /// Point i is voxel i's.
  [[nodiscard]] const ClusteredPoints& points() const { return points_; }
  [[nodiscard]] const ClusterBoxes& boxes() const { return boxes_; }
  /// In order of their keys.
  [[nodiscard]] std::span<const Block> blocks() const { return blocks_; }

  /// The clusters of blocks [x_first, x_end) of a row. O(1) where the map's box is not much larger than what it holds.
  [[nodiscard]] Range in_row(int x_first, int x_end, int y, int z) const;

  [[nodiscard]] std::size_t bytes() const;

 private:
  // Eight blocks of a row: a bit for each that holds something, and above them how many do so before these.
  using Octet = std::uint32_t;
  static constexpr int kOctet = 8;

  void add_points(const VoxelMap& map, VoxelPosition position);
  void add_block(const VoxelBlock& block);
  void index_rows();
  [[nodiscard]] std::uint32_t blocks_before(int x, std::size_t row) const;
  [[nodiscard]] std::uint32_t blocks_before_key(std::uint64_t key) const;

  ClusteredPoints points_;
  ClusterBoxes boxes_;
  std::vector<Block> blocks_;
  Eigen::Vector3i low_ = Eigen::Vector3i::Zero();   // first block of the table
  Eigen::Vector3i size_ = Eigen::Vector3i::Zero();  // blocks on each axis
  std::size_t octets_in_row_ = 0;
  std::vector<Octet> octets_;  // by z, y and x; none where they would be too many
};

}  // namespace kilter
