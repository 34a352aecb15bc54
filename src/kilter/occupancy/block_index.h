// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "kilter/occupancy/voxel_index.h"

namespace kilter {

/// Finds the number of a block by its coordinates: a dense table over the bounding box where that is small, open
/// addressing otherwise. Immutable after construction; O(1) look-up.
class BlockIndex {
 public:
  static constexpr std::int32_t kNone = -1;

  BlockIndex() = default;
  /// `keys` sorted ascending without repeats; block i has number i.
  explicit BlockIndex(std::span<const std::uint64_t> keys);

  [[nodiscard]] std::int32_t find(const Eigen::Vector3i& block) const {
    // Outside nothing is there, and keys of blocks far away are those of others.
    if ((block.array() < low_.array()).any() || (block.array() > high_.array()).any()) return kNone;
    if (dense_.empty()) return find_hashed(block_key(block));
    const Eigen::Vector3i p = block - low_;
    return dense_[(static_cast<std::size_t>(p.z()) * size_.y() + p.y()) * size_.x() + p.x()];
  }

  [[nodiscard]] std::size_t bytes() const;

 private:
  [[nodiscard]] std::int32_t find_hashed(std::uint64_t key) const;
  void build_hash(std::span<const std::uint64_t> keys);

  Eigen::Vector3i low_ = Eigen::Vector3i::Ones();  // first and last block on each axis; none if low_ is above high_
  Eigen::Vector3i high_ = Eigen::Vector3i::Zero();
  Eigen::Vector3i size_ = Eigen::Vector3i::Zero();
  std::vector<std::int32_t> dense_;
  std::vector<std::uint64_t> slot_keys_;
  std::vector<std::int32_t> slot_numbers_;
};

/// Spreads block keys over a table whose size is a power of two.
[[nodiscard]] inline std::size_t block_hash(std::uint64_t key) {
  key ^= key >> 31;
  key *= 0x9E3779B97F4A7C15ULL;
  return static_cast<std::size_t>(key ^ key >> 29);
}

}  // namespace kilter
