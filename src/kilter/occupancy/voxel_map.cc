// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/occupancy/voxel_map.h"

#include <cmath>

#include "kilter/base/contract.h"

namespace kilter {

VoxelMap::VoxelMap(double resolution_m, bool has_free_space, std::vector<VoxelBlock> blocks, SurfaceVoxels voxels)
    : resolution_m_(resolution_m),
      has_free_space_(has_free_space),
      blocks_(std::move(blocks)),
      voxels_(std::move(voxels)) {
  KILTER_EXPECTS(resolution_m > 0.0);
  std::vector<std::uint64_t> keys(blocks_.size());
  for (std::size_t i = 0; i < blocks_.size(); ++i) keys[i] = blocks_[i].key;
  index_ = BlockIndex(keys);
  indices_.reserve(voxels_.size());
  for (const VoxelBlock& block : blocks_) {
    const Eigen::Vector3i at = block_of_key(block.key);
    for (int z = 0; z < kBlockSize; ++z) {
      for (std::uint64_t bits = block.occupied[static_cast<std::size_t>(z)]; bits != 0; bits &= bits - 1) {
        indices_.push_back(voxel_of(at, std::countr_zero(bits) + 64 * z));
        const Eigen::Vector3d corner = indices_.back().cast<double>() * resolution_m_;
        bounds_m_.extend(corner);
        bounds_m_.extend(corner + Eigen::Vector3d::Constant(resolution_m_));
      }
    }
  }
  KILTER_EXPECTS(indices_.size() == voxels_.size());
}

CellState VoxelMap::state(const VoxelIndex& voxel) const {
  const std::int32_t number = index_.find(block_of(voxel));
  if (number == BlockIndex::kNone) return CellState::kUnknown;
  const VoxelBlock& block = blocks_[static_cast<std::size_t>(number)];
  const int bit = bit_of(voxel);
  const std::uint64_t mask = std::uint64_t{1} << (bit & 63);
  const auto layer = static_cast<std::size_t>(bit >> 6);
  if ((block.occupied[layer] & mask) != 0) return CellState::kOccupied;
  return (block.free[layer] & mask) != 0 ? CellState::kFree : CellState::kUnknown;
}

std::int64_t VoxelMap::find_voxel(const VoxelIndex& voxel) const {
  const std::int32_t number = index_.find(block_of(voxel));
  if (number == BlockIndex::kNone) return -1;
  const VoxelBlock& block = blocks_[static_cast<std::size_t>(number)];
  const int bit = bit_of(voxel);
  if ((block.occupied[static_cast<std::size_t>(bit >> 6)] >> (bit & 63) & 1) == 0) return -1;
  return block.first_voxel + rank_in_block(block, bit);
}

double VoxelMap::probability(std::size_t i) const {
  return 1.0 / (1.0 + std::exp(-static_cast<double>(voxels_.log_odds[i])));
}

std::size_t VoxelMap::bytes() const {
  const std::size_t per_voxel = 2 * sizeof(Eigen::Vector3f) + 2 * sizeof(float) + sizeof(std::uint8_t) +
                                sizeof(std::uint16_t) + sizeof(VoxelIndex);
  return blocks_.size() * sizeof(VoxelBlock) + voxels_.size() * per_voxel + index_.bytes();
}

}  // namespace kilter
