// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/occupancy/scan_marks.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "kilter/base/contract.h"

namespace kilter {

Eigen::Vector3i ScanMarks::Window::block(std::uint64_t place) const {
  Eigen::Vector3i block = low;
  for (int axis = 0; axis < 3; ++axis) {
    block[axis] += static_cast<int>(place >> shift(axis) & ((std::uint64_t{1} << bits[axis]) - 1));
  }
  return block;
}

void ScanMarks::begin(const Eigen::Vector3i& low, const Eigen::Vector3i& high) {
  window_.low = low;
  for (int axis = 0; axis < 3; ++axis) {
    window_.bits[axis] = static_cast<int>(std::bit_width(static_cast<std::uint32_t>(high[axis] - low[axis])));
  }
  if (!is_dense()) return;
  table_.resize(std::max(table_.size(), (std::size_t{1} << window_.total_bits()) + 1), 0);
  open(nowhere() >> kBitBits);
}

std::uint32_t ScanMarks::open(std::uint64_t block) {
  opened_.push_back(block);
  const std::size_t offset = opened_.size() * kBlockVoxels;  // the first block's bytes are left, so that 0 is none
  KILTER_EXPECTS(offset <= std::numeric_limits<std::uint32_t>::max());
  if (bytes_.size() < offset + kBlockVoxels) bytes_.resize(std::max(offset + kBlockVoxels, bytes_.size() * 2), 0);
  return (is_dense() ? table_[block] : sparse_[block]) = static_cast<std::uint32_t>(offset);
}

}  // namespace kilter
