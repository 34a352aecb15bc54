// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/base/parallel.h"

#include <exception>
#include <mutex>
#include <thread>

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
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
void run_on_threads(int threads, const std::function<void()>& work) {
  std::vector<std::jthread> workers;
  for (int t = 0; t < threads; ++t) workers.emplace_back(work);
}
#else
void run_on_threads(int threads, const std::function<void()>& work) {
  // More than there are processors is the caller's to ask for; without this TBB says on standard error that it refuses.
  const tbb::global_control allowed(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  tbb::task_arena arena(threads);
  arena.execute([&] {
    tbb::parallel_for(
        0, threads, [&](int) { work(); }, tbb::simple_partitioner());
  });
}
#endif

// Calls one(i) for all i on several threads, taken in ascending order, so that what is near in time is near in index.
void share_out(std::size_t count, int threads, const std::function<void(std::size_t)>& one) {
  std::atomic<std::size_t> next = 0;
  std::exception_ptr failure;
  std::mutex failure_mutex;
  run_on_threads(threads, [&] {
    try {
      for (std::size_t i = next++; i < count; i = next++) one(i);
    } catch (...) {
      const std::scoped_lock lock(failure_mutex);
      if (!failure) failure = std::current_exception();
      next = count;
    }
  });
  if (failure) std::rethrow_exception(failure);
}

}  // namespace

RunContext part_of(const RunContext& run, std::size_t before, std::size_t total) {
  RunContext part = run;
  if (run.progress) {
    part.progress = [&run, before, total](std::size_t done, std::size_t) { run.progress(before + done, total); };
  }
  return part;
}

int available_processors() { return std::max(tbb::info::default_concurrency(), 1); }

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
  share_out(count, static_cast<int>(std::min(count, static_cast<std::size_t>(run.threads))), one);
}

}  // namespace kilter
