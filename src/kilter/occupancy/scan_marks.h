// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "kilter/occupancy/voxel_index.h"

namespace kilter {

/// What one scan says of voxels: a byte each, in blocks that are opened where the scan touches them.
///
/// The blocks of a scan lie in a window whose sides are powers of two, so that a voxel's place in the window is one
/// number: 3 bits of x, y and z inside its block (bit_of), then the block's x, y and z. A table over the window's
/// blocks says where the bytes are. A window that is too large for a table (kMostDenseBits) has no places, which need
/// not fit 64 bits there: it is served by a hash map over block keys instead, and only by mark().
class ScanMarks {
 public:
  static constexpr std::uint8_t kMiss = 1;
  static constexpr std::uint8_t kHit = 2;
  static constexpr int kBitBits = 3 * kBlockShift;
  static constexpr int kMostDenseBits = 24;

  /// Where voxels of a dense window have their place.
  struct Window {
    Eigen::Vector3i low = Eigen::Vector3i::Zero();   ///< first block
    Eigen::Vector3i bits = Eigen::Vector3i::Zero();  ///< log2 of the blocks on each side

    [[nodiscard]] int total_bits() const { return bits.sum(); }
    /// Where the block's coordinate on this axis begins in a place.
    [[nodiscard]] int shift(int axis) const { return kBitBits + (axis > 0 ? bits.x() : 0) + (axis > 1 ? bits.y() : 0); }
    /// All bits of a place that say where on this axis.
    [[nodiscard]] std::uint64_t mask(int axis) const {
      return std::uint64_t{kBlockSize - 1} << (kBlockShift * axis) | ((std::uint64_t{1} << bits[axis]) - 1)
                                                                         << shift(axis);
    }
    /// Of a voxel inside the window.
    [[nodiscard]] std::uint64_t place(const VoxelIndex& voxel) const {
      const Eigen::Vector3i block = block_of(voxel) - low;
      return static_cast<std::uint64_t>(bit_of(voxel)) | static_cast<std::uint64_t>(block.x()) << shift(0) |
             static_cast<std::uint64_t>(block.y()) << shift(1) | static_cast<std::uint64_t>(block.z()) << shift(2);
    }
    [[nodiscard]] Eigen::Vector3i block(std::uint64_t place) const;
  };

  /// Opens a window around blocks low..high. Everything is unmarked.
  void begin(const Eigen::Vector3i& low, const Eigen::Vector3i& high);

  [[nodiscard]] const Window& window() const { return window_; }
  [[nodiscard]] bool is_dense() const { return window_.total_bits() <= kMostDenseBits; }

  /// Marks a voxel of the window.
  void mark(const VoxelIndex& voxel, std::uint8_t what) {
    const bool dense = is_dense();
    const std::uint64_t block = dense ? window_.place(voxel) >> kBitBits : block_key(block_of(voxel));
    std::uint32_t offset = dense ? table_[block] : sparse_[block];
    if (offset == 0) offset = open(block);
    bytes_[offset + static_cast<std::size_t>(bit_of(voxel))] = what;
  }

  /// The window's table, by place >> kBitBits: where the block's marks begin in bytes(), 0 for none yet. Dense windows
  /// only.
  [[nodiscard]] const std::uint32_t* table() const { return table_.data(); }
  [[nodiscard]] std::uint8_t* bytes() { return bytes_.data(); }
  /// A place outside the window that may be marked all the same: nobody asks. Dense windows only.
  [[nodiscard]] std::uint64_t nowhere() const { return std::uint64_t{1} << (window_.total_bits() + kBitBits); }
  /// Gives a block (of the table, or by its key) its bytes; moves bytes(), not table().
  std::uint32_t open(std::uint64_t block);

  /// What the marks since begin() take.
  [[nodiscard]] std::size_t held_bytes() const { return opened_.size() * (kBlockVoxels + sizeof(std::uint64_t)); }

  /// Calls visit(block coordinates, its kBlockVoxels marks) for every block that was opened, in the order of opening,
  /// and forgets all marks.
  template <typename Visit>
  void take(const Visit& visit);

 private:
  Window window_;
  std::vector<std::uint32_t> table_;
  std::unordered_map<std::uint64_t, std::uint32_t> sparse_;
  std::vector<std::uint64_t> opened_;  // by place >> kBitBits, or by key
  std::vector<std::uint8_t> bytes_;
};

template <typename Visit>
void ScanMarks::take(const Visit& visit) {
  for (std::size_t i = 0; i < opened_.size(); ++i) {
    const std::span<std::uint8_t, kBlockVoxels> marks(bytes_.data() + (i + 1) * kBlockVoxels, kBlockVoxels);
    const std::uint64_t place = opened_[i] << kBitBits;
    const bool is_nowhere = is_dense() && place == nowhere();
    const Eigen::Vector3i block = is_dense() ? window_.block(place) : block_of_key(opened_[i]);
    if (!is_nowhere) visit(block, std::span<const std::uint8_t, kBlockVoxels>(marks));
    std::fill(marks.begin(), marks.end(), std::uint8_t{0});
    if (is_dense()) table_[opened_[i]] = 0;
  }
  opened_.clear();
  sparse_.clear();
}

}  // namespace kilter
