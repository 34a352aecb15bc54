// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/occupancy/block_index.h"

#include <bit>

namespace kilter {
namespace {

// A dense table pays while it costs no more than this many entries a block (a block itself holds 144 bytes).
constexpr std::size_t kDenseEntriesPerBlock = 32;
constexpr std::size_t kDenseAlways = 1 << 16;

}  // namespace

BlockIndex::BlockIndex(std::span<const std::uint64_t> keys) {
  if (keys.empty()) return;
  low_ = high_ = block_of_key(keys.front());
  for (const std::uint64_t key : keys) {
    const Eigen::Vector3i block = block_of_key(key);
    low_ = low_.cwiseMin(block);
    high_ = high_.cwiseMax(block);
  }
  size_ = high_ - low_ + Eigen::Vector3i::Ones();
  const double volume = size_.cast<double>().prod();
  if (volume > static_cast<double>(kDenseAlways + kDenseEntriesPerBlock * keys.size())) {
    build_hash(keys);
    return;
  }
  dense_.assign(static_cast<std::size_t>(volume), kNone);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const Eigen::Vector3i p = block_of_key(keys[i]) - low_;
    dense_[(static_cast<std::size_t>(p.z()) * size_.y() + p.y()) * size_.x() + p.x()] = static_cast<std::int32_t>(i);
  }
}

void BlockIndex::build_hash(std::span<const std::uint64_t> keys) {
  const std::size_t capacity = std::bit_ceil(keys.size() * 2);
  slot_keys_.assign(capacity, 0);
  slot_numbers_.assign(capacity, kNone);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    std::size_t slot = block_hash(keys[i]) & (capacity - 1);
    while (slot_numbers_[slot] != kNone) slot = (slot + 1) & (capacity - 1);
    slot_keys_[slot] = keys[i];
    slot_numbers_[slot] = static_cast<std::int32_t>(i);
  }
}

std::int32_t BlockIndex::find_hashed(std::uint64_t key) const {
  if (slot_numbers_.empty()) return kNone;
  const std::size_t mask = slot_numbers_.size() - 1;
  for (std::size_t slot = block_hash(key) & mask;; slot = (slot + 1) & mask) {
    if (slot_numbers_[slot] == kNone || slot_keys_[slot] == key) return slot_numbers_[slot];
  }
}

std::size_t BlockIndex::bytes() const {
  return dense_.size() * sizeof(std::int32_t) + slot_keys_.size() * (sizeof(std::uint64_t) + sizeof(std::int32_t));
}

}  // namespace kilter
