// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/base/parallel.h"

#include <gtest/gtest.h>

#include <numeric>
#include <stdexcept>

namespace kilter {
namespace {

struct Sum {
  double value = 0.0;
  void merge(const Sum& other) { value += other.value; }
};

TEST(ParallelFor, VisitsEveryIndexOnce) {
  for (const int threads : {1, 2, 4}) {
    std::vector<int> visits(1000, 0);
    parallel_for(visits.size(), {.threads = threads}, [&](std::size_t i) { ++visits[i]; });
    EXPECT_EQ(std::count(visits.begin(), visits.end(), 1), 1000);
  }
}

TEST(ParallelFor, StopsWhenAsked) {
  std::atomic<bool> cancelled = false;
  int visited = 0;
  parallel_for(100, {.threads = 1, .cancelled = &cancelled}, [&](std::size_t i) {
    ++visited;
    if (i == 9) cancelled = true;
  });
  EXPECT_EQ(visited, 10);
}

TEST(ParallelFor, RethrowsWhatTheBodyThrows) {
  EXPECT_THROW(parallel_for(8, {.threads = 2}, [](std::size_t) { throw std::runtime_error("body"); }),
               std::runtime_error);
}

TEST(PartOf, CountsBehindWhatWasDone) {
  std::vector<std::pair<std::size_t, std::size_t>> told;
  const RunContext run{.progress = [&](std::size_t done, std::size_t total) { told.emplace_back(done, total); }};
  parallel_for(2, part_of(run, 0, 5), [](std::size_t) {});
  parallel_for(3, part_of(run, 2, 5), [](std::size_t) {});
  EXPECT_EQ(told, (std::vector<std::pair<std::size_t, std::size_t>>{{1, 5}, {2, 5}, {3, 5}, {4, 5}, {5, 5}}));
  EXPECT_FALSE(part_of({}, 2, 5).progress) << "nobody listens";
}

TEST(ReduceBlocks, GivesTheSameBitsForAnyThreadCount) {
  std::vector<double> values(100000);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = 1.0 / static_cast<double>(i + 1);
  const auto fold = [](std::span<const double> block) { return Sum{std::accumulate(block.begin(), block.end(), 0.0)}; };
  const double one = reduce_blocks(std::span<const double>(values), Sum{}, {.threads = 1}, fold).value;
  const double four = reduce_blocks(std::span<const double>(values), Sum{}, {.threads = 4}, fold).value;
  EXPECT_EQ(one, four);
  EXPECT_NEAR(one, 12.0901461, 1e-6);
}

}  // namespace
}  // namespace kilter
