// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/base/parallel.h"

#include <exception>
#include <mutex>
#include <thread>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "kilter/base/contract.h"

// Debian's TBB is not built for ThreadSanitizer, which then cannot see how TBB hands work from thread to thread and
// reports every piece of it. Under that sanitizer plain threads do the same job, so that what it reports is ours.
#if defined(__SANITIZE_THREAD__)
#define KILTER_PLAIN_THREADS 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define KILTER_PLAIN_THREADS 1
#endif
#endif

namespace kilter {
namespace {

#ifdef KILTER_PLAIN_THREADS
void run_on_threads(std::size_t count, int threads, const std::function<void(std::size_t)>& one) {
  std::atomic<std::size_t> next = 0;
  std::exception_ptr failure;
  std::mutex failure_mutex;
  const auto work = [&] {
    try {
      for (std::size_t i = next++; i < count; i = next++) one(i);
    } catch (...) {
      const std::scoped_lock lock(failure_mutex);
      if (!failure) failure = std::current_exception();
      next = count;
    }
  };
  {
    std::vector<std::jthread> workers;
    for (int t = 0; t < threads; ++t) workers.emplace_back(work);
  }
  if (failure) std::rethrow_exception(failure);
}
#else
void run_on_threads(std::size_t count, int threads, const std::function<void(std::size_t)>& one) {
  tbb::task_arena arena(threads);
  arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
          for (std::size_t i = range.begin(); i != range.end(); ++i) one(i);
        },
        tbb::simple_partitioner());
  });
}
#endif

}  // namespace

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
  run_on_threads(count, run.threads, one);
}

}  // namespace kilter
