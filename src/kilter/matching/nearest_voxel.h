// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "kilter/occupancy/voxel_map.h"

namespace kilter {

/// Which point stands for a voxel.
enum class VoxelPosition {
  kCentre,    ///< the middle of the lattice cell, as in the seed
  kCentroid,  ///< the mean of the hits inside
};

/// Position of occupied voxel i in the map's frame. [m]
[[nodiscard]] Eigen::Vector3d voxel_position_m(const VoxelMap& map, std::size_t i, VoxelPosition position);

/// An occupied voxel and how far it is. [m]
struct NearestVoxel {
  std::uint32_t voxel = 0;
  double distance_m = 0.0;
};

/// Exact closest-voxel search on the blocks of one map: blocks in order of their distance, voxels of a block as one
/// array. Immutable after construction; the map must outlive it. Ties go to the lower voxel number.
class NearestVoxelSearch {
 public:
  /// \param max_distance_m  no query may ask for more. O(voxels).
  NearestVoxelSearch(const VoxelMap& map, VoxelPosition position, double max_distance_m);

  /// The closest occupied voxel no farther than `limit_m` (<= max_distance_m) from a point in the map's frame.
  [[nodiscard]] std::optional<NearestVoxel> nearest(const Eigen::Vector3d& point_m, double limit_m) const;

  [[nodiscard]] const VoxelMap& map() const { return *map_; }
  [[nodiscard]] VoxelPosition position() const { return position_; }
  [[nodiscard]] double max_distance_m() const { return max_distance_m_; }

 private:
  friend class NearestVoxelCursor;
  struct BlockOffset {
    Eigen::Vector3i offset;
    double least_m2;  // no point of the query's block is nearer to that block
  };

  void scan_block(const VoxelBlock& block, const Eigen::Vector3f& point, float& best2, std::uint32_t& best) const;

  const VoxelMap* map_;
  VoxelPosition position_;
  double max_distance_m_;
  std::vector<float> x_, y_, z_;      // positions in voxel order
  std::vector<BlockOffset> offsets_;  // sorted by least distance
};

/// The same search for many points: remembers which of the blocks around a point's block hold surfaces, so that points
/// near each other, and the same points under another pose, look nothing up. Same answers to the bit. One for each
/// thread; keep it as long as poses of one pair change. Memory is bounded (kMostHomes).
class NearestVoxelCursor {
 public:
  /// The search must outlive it.
  explicit NearestVoxelCursor(const NearestVoxelSearch& search);

  /// \sa NearestVoxelSearch::nearest
  [[nodiscard]] std::optional<NearestVoxel> nearest(const Eigen::Vector3d& point_m, double limit_m);

 private:
  static constexpr std::size_t kMostHomes = 1 << 13;

  struct NearBlock {
    Eigen::Array3f low_m;  // the block's lower corner
    float least_m2;        // no point of the home block is nearer
    const VoxelBlock* block;
  };
  // What lies around one block, sorted by least distance, as far as was needed yet.
  struct Home {
    Eigen::Vector3i at;
    std::vector<NearBlock> near;
    std::size_t looked_at = 0;  // offsets that `near` covers
  };

  Home& home_at(const Eigen::Vector3i& block);
  // Whether home.near has an entry k, looking for it among blocks that can hold something nearer than best2.
  bool has_near(Home& home, std::size_t k, float best2) const;

  const NearestVoxelSearch* search_;
  std::vector<Home> homes_;
  std::vector<std::uint32_t> table_;  // open addressing: home number + 1, 0 = empty
  std::uint32_t last_ = 0;            // home number + 1 of the last point
};

}  // namespace kilter
