// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "kilter/occupancy/block_index.h"
#include "kilter/occupancy/voxel_index.h"

namespace kilter {

/// What a lattice cell is known to be.
enum class CellState { kUnknown, kFree, kOccupied };

/// 512 voxels: one bit each for occupied and free; neither means unknown.
struct VoxelBlock {
  std::uint64_t key = 0;
  std::array<std::uint64_t, kBlockSize> occupied{};
  std::array<std::uint64_t, kBlockSize> free{};
  std::uint32_t first_voxel = 0;  ///< number of this block's first occupied voxel
  std::uint32_t voxel_count = 0;  ///< how many voxels of this block are occupied
};

/// Occupied voxels, one entry each, in block order and bit order inside a block. Positions in the map's frame.
struct SurfaceVoxels {
  std::vector<Eigen::Vector3f> centroids_m;  ///< mean of the hits inside the voxel
  std::vector<Eigen::Vector3f> normals;      ///< unit, towards the sensor; zero where no plane could be fitted
  std::vector<float> planarity;              ///< 0 (a blob or no support) .. 1 (a plane)
  std::vector<float> log_odds;               ///< of being occupied
  std::vector<std::uint8_t> seen_at;         ///< mean over the hits of the scan's place in time: 0 first .. 255 last
  std::vector<std::uint16_t> hits;           ///< how many points lie in the voxel, at most 65,535; 1 where nobody knows
  /// Edge of the cells of which centroids are the mere centres, and so up to half of it off their surface, all voxels
  /// of a wall alike; 0 where they are means of hits. Never less than a voxel, otherwise. [m]
  double cell_m = 0.0;

  [[nodiscard]] std::size_t size() const { return centroids_m.size(); }
};

/// A finished probabilistic occupancy map: immutable, safe to read from many threads.
class VoxelMap {
 public:
  VoxelMap() = default;
  /// `blocks` sorted by key without repeats, with first_voxel and voxel_count set to match `voxels`.
  VoxelMap(double resolution_m, bool has_free_space, std::vector<VoxelBlock> blocks, SurfaceVoxels voxels);

  [[nodiscard]] double resolution_m() const { return resolution_m_; }
  /// False for maps made of points alone: nothing is known to be free then.
  [[nodiscard]] bool has_free_space() const { return has_free_space_; }
  [[nodiscard]] std::span<const VoxelBlock> blocks() const { return blocks_; }
  [[nodiscard]] const SurfaceVoxels& voxels() const { return voxels_; }
  /// Edge of the cells that centroids are the centres of; 0 where they are means of hits (SurfaceVoxels::cell_m). [m]
  [[nodiscard]] double cell_m() const { return voxels_.cell_m; }
  /// Lattice index of every occupied voxel, in voxel order.
  [[nodiscard]] const std::vector<VoxelIndex>& indices() const { return indices_; }
  /// Box around all occupied voxels; empty box if there is none. [m]
  [[nodiscard]] const Eigen::AlignedBox3d& bounds_m() const { return bounds_m_; }

  /// Number of the block, or BlockIndex::kNone.
  [[nodiscard]] std::int32_t find_block(const Eigen::Vector3i& block) const { return index_.find(block); }

  [[nodiscard]] CellState state(const VoxelIndex& voxel) const;

  /// Number of an occupied voxel, or -1.
  [[nodiscard]] std::int64_t find_voxel(const VoxelIndex& voxel) const;

  /// Calls visit(voxel number) for every occupied voxel whose index lies from `low` to `high`, both included, on each
  /// axis, in ascending order inside each block.
  template <typename Visit>
  void visit_box(const VoxelIndex& low, const VoxelIndex& high, const Visit& visit) const;

  /// Probability of being occupied of voxel number i.
  [[nodiscard]] double probability(std::size_t i) const;

  /// Memory held, counted from sizes (not capacities), so equal input gives an equal figure. [bytes]
  [[nodiscard]] std::size_t bytes() const;

 private:
  double resolution_m_ = 0.1;
  bool has_free_space_ = false;
  std::vector<VoxelBlock> blocks_;
  SurfaceVoxels voxels_;
  std::vector<VoxelIndex> indices_;
  BlockIndex index_;
  Eigen::AlignedBox3d bounds_m_;
};

/// Number of occupied voxels of `block` that come before `bit`.
[[nodiscard]] inline std::uint32_t rank_in_block(const VoxelBlock& block, int bit) {
  std::uint32_t rank = 0;
  const int layer = bit >> 6;
  for (int z = 0; z < layer; ++z) rank += static_cast<std::uint32_t>(std::popcount(block.occupied[z]));
  const std::uint64_t below = (std::uint64_t{1} << (bit & 63)) - 1;
  return rank + static_cast<std::uint32_t>(std::popcount(block.occupied[layer] & below));
}

template <typename Visit>
void VoxelMap::visit_box(const VoxelIndex& low, const VoxelIndex& high, const Visit& visit) const {
  const Eigen::Vector3i first = block_of(low);
  const Eigen::Vector3i last = block_of(high);
  for (int bz = first.z(); bz <= last.z(); ++bz) {
    for (int by = first.y(); by <= last.y(); ++by) {
      for (int bx = first.x(); bx <= last.x(); ++bx) {
        const std::int32_t number = index_.find({bx, by, bz});
        if (number == BlockIndex::kNone) continue;
        const VoxelBlock& block = blocks_[static_cast<std::size_t>(number)];
        if (block.voxel_count == 0) continue;
        const Eigen::Vector3i corner = Eigen::Vector3i(bx, by, bz) * kBlockSize;
        const Eigen::Vector3i from = (low - corner).cwiseMax(0);
        const Eigen::Vector3i to = (high - corner).cwiseMin(kBlockSize - 1);
        const std::uint64_t row = (0xFFULL >> (7 - to.x())) & (0xFFULL << from.x());
        std::uint64_t layer_mask = 0;
        for (int y = from.y(); y <= to.y(); ++y) layer_mask |= row << (8 * y);
        std::uint32_t before = block.first_voxel;
        for (int z = 0; z <= to.z(); ++z) {
          const std::uint64_t layer = block.occupied[static_cast<std::size_t>(z)];
          if (z >= from.z()) {
            for (std::uint64_t bits = layer & layer_mask; bits != 0; bits &= bits - 1) {
              const std::uint64_t lowest = bits & (~bits + 1);
              visit(before + static_cast<std::uint32_t>(std::popcount(layer & (lowest - 1))));
            }
          }
          before += static_cast<std::uint32_t>(std::popcount(layer));
        }
      }
    }
  }
}

}  // namespace kilter
