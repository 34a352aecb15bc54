// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/base/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "kilter/base/contract.h"

namespace kilter {

void parallel_for(std::size_t count, const RunContext& run, const std::function<void(std::size_t)>& body) {
  KILTER_EXPECTS(run.threads >= 1);
  std::atomic<std::size_t> done = 0;
  const auto one = [&](std::size_t i) {
    if (run.stop_requested()) return;
    body(i);
    if (run.progress) run.progress(done.fetch_add(1) + 1, count);
  };
  if (run.threads == 1 || count <= 1) {
    for (std::size_t i = 0; i < count; ++i) one(i);
    return;
  }
  tbb::task_arena arena(run.threads);
  arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
          for (std::size_t i = range.begin(); i != range.end(); ++i) one(i);
        },
        tbb::simple_partitioner());
  });
}

}  // namespace kilter
