// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "kilter/occupancy/block_index.h"

namespace kilter {

/// Numbers keys in the order in which they first come, from 0: open addressing, a step or two for each. The last key is
/// remembered, since neighbours ask one after the other.
class KeyNumbers {
 public:
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;

  /// The key's number; what size() was, if it is new.
  std::uint32_t find_or_add(std::uint64_t key) {
    if (!keys_.empty() && keys_[last_] == key) return last_;
    const std::size_t slot = slot_of(key);
    if (table_[slot] != 0) return last_ = table_[slot] - 1;
    keys_.push_back(key);
    table_[slot] = static_cast<std::uint32_t>(keys_.size());
    if (2 * keys_.size() > table_.size()) grow();
    return last_ = static_cast<std::uint32_t>(keys_.size() - 1);
  }

  /// The key's number, or kNone.
  [[nodiscard]] std::uint32_t find(std::uint64_t key) const { return table_[slot_of(key)] - 1; }

  /// By number.
  [[nodiscard]] const std::vector<std::uint64_t>& keys() const { return keys_; }
  [[nodiscard]] std::size_t size() const { return keys_.size(); }

 private:
  [[nodiscard]] std::size_t slot_of(std::uint64_t key) const {
    std::size_t slot = block_hash(key) & (table_.size() - 1);
    while (table_[slot] != 0 && keys_[table_[slot] - 1] != key) slot = (slot + 1) & (table_.size() - 1);
    return slot;
  }

  void grow() {
    table_.assign(4 * table_.size(), 0);
    for (std::size_t i = 0; i < keys_.size(); ++i) table_[slot_of(keys_[i])] = static_cast<std::uint32_t>(i + 1);
  }

  std::vector<std::uint64_t> keys_;
  std::vector<std::uint32_t> table_ = std::vector<std::uint32_t>(256, 0);  // number + 1, 0 = empty
  std::uint32_t last_ = 0;
};

}  // namespace kilter
