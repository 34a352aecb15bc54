// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace kilter {

/// How a stage may run: its budgets and a flag that asks it to stop.
struct RunContext {
  int threads = 1;                               ///< >= 1
  const std::atomic<bool>* cancelled = nullptr;  ///< may be null
  /// Told (done, total) from any thread, in no promised order; may be empty.
  std::function<void(std::size_t done, std::size_t total)> progress = {};
  std::size_t memory_bytes = 0;  ///< what all that it keeps may take, and so also a single thing of it; 0 = no limit

  [[nodiscard]] bool stop_requested() const { return cancelled != nullptr && cancelled->load(); }
};

/// The same run, for a part of a stage: what the part says it has done counts behind `before`, of `total`.
/// Whoever calls keeps `run` alive.
[[nodiscard]] RunContext part_of(const RunContext& run, std::size_t before, std::size_t total);

/// Processors that this process may use, at least 1: those that an affinity mask leaves, not all that the machine has.
[[nodiscard]] int available_processors();

/// Calls `body(i)` for every i in [0, count), on at most `run.threads` threads, taken in ascending order; stops early
/// (leaving the rest uncalled) once a stop is requested. `body` must only write to what belongs to i. An exception
/// of `body` is rethrown here.
void parallel_for(std::size_t count, const RunContext& run, const std::function<void(std::size_t)>& body);

/// Sums that reach a result: folds blocks of fixed size in index order, so thread count never changes a bit.
/// `fold(span) -> R`, R has `merge(const R&)`.
template <typename T, typename R, typename Fold>
[[nodiscard]] R reduce_blocks(std::span<const T> values, R start, const RunContext& run, const Fold& fold) {
  constexpr std::size_t kBlock = 4096;
  const std::size_t blocks = (values.size() + kBlock - 1) / kBlock;
  std::vector<R> partial(blocks, start);
  parallel_for(blocks, run, [&](std::size_t b) {
    const std::size_t first = b * kBlock;
    partial[b] = fold(values.subspan(first, std::min(kBlock, values.size() - first)));
  });
  for (const R& part : partial) start.merge(part);
  return start;
}

}  // namespace kilter
