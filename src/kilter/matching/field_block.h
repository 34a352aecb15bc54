// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "kilter/base/vector_path.h"
#include "kilter/matching/look_up.h"
#include "kilter/occupancy/voxel_map.h"

namespace kilter {

/// The farthest that a field may reach. [cells]
inline constexpr int kMostFieldReach = 24;

/// Which blocks of a box hold occupied voxels: a bit for each, so that a row of neighbours takes one look.
class OccupiedBlocks {
 public:
  OccupiedBlocks() = default;
  /// O(blocks of the map and of the box's rows). \pre all blocks of the map that hold something lie in the box.
  OccupiedBlocks(const VoxelMap& map, const FieldBox& box);

  /// How far beyond the box may be asked. [blocks]
  static constexpr int kMargin = (kMostFieldReach + kBlockSize - 1) / kBlockSize;

  /// A bit for each of eight blocks of a row, of which (x, y, z) is the first, counted from the box's first one.
  [[nodiscard]] std::uint32_t eight_from(int x, int y, int z) const {
    if (y < 0 || y >= size_.y() || z < 0 || z >= size_.z()) return 0;
    const std::size_t bit = static_cast<std::uint32_t>(x + kMargin);
    const std::uint8_t* const at = bits_.data() + (static_cast<std::size_t>(z) * size_.y() + y) * row_bytes_ + bit / 8;
    return (at[0] | static_cast<std::uint32_t>(at[1]) << 8) >> bit % 8 & 0xFF;
  }

  [[nodiscard]] std::size_t bytes() const { return bits_.size(); }

 private:
  Eigen::Vector3i size_ = Eigen::Vector3i::Zero();
  std::size_t row_bytes_ = 0;
  std::vector<std::uint8_t> bits_;  // rows by z, then y, with a margin at both ends
};

using FieldBlock = std::array<FieldCell, kBlockVoxels>;

/// Fills in what a field says of the cells of one block: for each the occupied voxel whose centre is nearest to the
/// cell's centre, if that is at most `reach` cells away; of equally near ones that of the lowest z, then y, then x. The
/// same on every path.
/// \param at  the block, counted from the box's first one.
/// \return false, and nothing filled in, if no block around it holds any voxel.
bool compute_field_block(const VoxelMap& map, const OccupiedBlocks& occupied, const FieldBox& box,
                         const Eigen::Vector3i& at, int reach, VectorPath path, FieldBlock& voxels);

}  // namespace kilter
