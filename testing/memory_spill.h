// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <mutex>
#include <optional>
#include <vector>

#include "kilter/pipeline/spill_space.h"

namespace kilter::testing {

/// Spill space in memory that counts what it is asked for, and fails when told to.
class MemorySpill final : public SpillSpace {
 public:
  Expected<SpillPlace> write(std::span<const std::byte> bytes) override {
    const std::scoped_lock lock(mutex_);
    if (refusal_) return tl::unexpected<Error>(*refusal_);
    const SpillPlace place{bytes_.size(), bytes.size()};
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    ++written_;
    return place;
  }

  Expected<void> read(const SpillPlace& place, std::span<std::byte> bytes) override {
    const std::scoped_lock lock(mutex_);
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(place.offset), bytes.size(), bytes.begin());
    ++reads_;
    return {};
  }

  void refuse_writes(Error error) { refusal_ = std::move(error); }
  void flip_a_bit() { bytes_[bytes_.size() / 2 % 97 + 64] ^= std::byte{1}; }
  [[nodiscard]] std::size_t written() const { return written_; }
  [[nodiscard]] std::size_t reads() const { return reads_; }

 private:
  std::mutex mutex_;
  std::vector<std::byte> bytes_;
  std::optional<Error> refusal_;
  std::size_t written_ = 0;
  std::size_t reads_ = 0;
};

}  // namespace kilter::testing
