// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstddef>
#include <limits>
#include <mutex>
#include <utility>

#include "kilter/base/expected.h"

namespace kilter {

/// What a parallel_for failed with: of all failures that of the lowest i, so that it is the same for any number of
/// threads. What comes after a failure need not be done, and what comes before it is. Any thread may ask and tell.
class LowestFailure {
 public:
  /// Whether a lower one has failed, so that nobody will ask what becomes of i.
  [[nodiscard]] bool is_before(std::size_t i) const { return lowest_.load() < i; }

  void keep(std::size_t i, Error error) {
    const std::scoped_lock lock(mutex_);
    if (i >= lowest_.load()) return;
    lowest_ = i;
    error_ = std::move(error);
  }

  /// Once all are done.
  [[nodiscard]] Expected<void> result() const {
    if (lowest_.load() == kNone) return {};
    return pass_up(error_);
  }

 private:
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  std::atomic<std::size_t> lowest_ = kNone;
  std::mutex mutex_;
  Error error_;
};

}  // namespace kilter
