// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/pipeline/pair_schedule.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <list>
#include <numeric>

namespace kilter {
namespace {

// A journey there and back: each submap meets those near it on either way.
std::vector<PairId> there_and_back(int submaps) {
  std::vector<PairId> pairs;
  const auto place = [&](int i) { return std::min(i, submaps - 1 - i); };
  for (int source = 0; source < submaps; ++source) {
    for (int target = 0; target < source; ++target) {
      if (std::abs(place(source) - place(target)) <= 5) pairs.push_back({{source}, {target}});
    }
  }
  return pairs;
}

// How often a submap has to be read when so many are held and the least recently used goes.
std::size_t reads(const std::vector<PairId>& pairs, std::span<const std::size_t> order, std::size_t held) {
  std::list<int> recent;
  std::size_t count = 0;
  for (const std::size_t i : order) {
    for (const int number : {pairs[i].source.value, pairs[i].target.value}) {
      const auto found = std::find(recent.begin(), recent.end(), number);
      if (found == recent.end()) {
        ++count;
        if (recent.size() == held) recent.pop_front();
      } else {
        recent.erase(found);
      }
      recent.push_back(number);
    }
  }
  return count;
}

TEST(OrderForReuse, HoldsEveryPairOnce) {
  const std::vector<PairId> pairs = there_and_back(60);
  std::vector<std::size_t> order = order_for_reuse(pairs);
  std::sort(order.begin(), order.end());
  std::vector<std::size_t> all(pairs.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  EXPECT_EQ(order, all);
  EXPECT_TRUE(order_for_reuse({}).empty());
}

TEST(OrderForReuse, NeedsFewReadsWithFewSubmapsHeld) {
  const std::vector<PairId> pairs = there_and_back(400);
  std::vector<std::size_t> as_they_come(pairs.size());
  std::iota(as_they_come.begin(), as_they_come.end(), std::size_t{0});
  EXPECT_LT(2 * reads(pairs, order_for_reuse(pairs), 10), reads(pairs, as_they_come, 10));
  EXPECT_LT(5 * reads(pairs, order_for_reuse(pairs), 6), 4 * reads(pairs, as_they_come, 6));
}

}  // namespace
}  // namespace kilter
