// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/pipeline/submap_store.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstring>
#include <functional>
#include <future>
#include <limits>
#include <memory>
#include <mutex>
#include <new>
#include <thread>

#include "kilter/occupancy/map_builder.h"
#include "kilter/occupancy/voxel_map_bytes.h"
#include "testing/allocation_watch.h"
#include "testing/memory_spill.h"

namespace kilter {
namespace {

using testing::MemorySpill;

// A wall that only submap `number` has.
VoxelMap wall(int number) {
  std::vector<Eigen::Vector3d> points;
  for (int y = 0; y < 20 + number; ++y) {
    for (int z = 0; z < 20; ++z) points.emplace_back(0.31 + 0.1 * number, 0.1 * y + 0.03, 0.1 * z + 0.04);
  }
  MapBuilder builder({.resolution_m = 0.1});
  builder.insert_points(points);
  return builder.finish();
}

std::size_t size_of(int number) { return SearchableMap(wall(number), {}).bytes(); }

void fill(SubmapStore& store, int count) {
  for (int i = 0; i < count; ++i) ASSERT_TRUE(store.add({i}, wall(i)).has_value()) << i;
}

TEST(SubmapStore, WithoutALimitNothingGoesOut) {
  MemorySpill spill;
  SubmapStore store(6, {}, {0, &spill});
  fill(store, 6);
  EXPECT_EQ(spill.written(), 0U);
  const auto pair = store.pin(PairId{{5}, {2}});
  ASSERT_TRUE(pair.has_value());
  EXPECT_EQ(bytes_of_map(pair->source->map()), bytes_of_map(wall(5)));
  EXPECT_EQ(bytes_of_map(pair->target->map()), bytes_of_map(wall(2)));
}

TEST(SubmapStore, WhatWentOutComesBackTheSameAndIsWrittenOnce) {
  MemorySpill spill;
  SubmapStore store(6, {}, {2 * size_of(6), &spill});
  fill(store, 6);
  for (int round = 0; round < 3; ++round) {
    for (int i = 0; i < 6; ++i) {
      const auto map = store.pin(SubmapId{i});
      ASSERT_TRUE(map.has_value()) << map.error().message;
      EXPECT_EQ(bytes_of_map((*map)->map()), bytes_of_map(wall(i)));
    }
  }
  EXPECT_LE(spill.written(), 6U);
  EXPECT_GT(spill.reads(), 6U);
}

TEST(SubmapStore, TheLeastRecentlyUsedGoesFirst) {
  MemorySpill spill;
  SubmapStore store(4, {}, {3 * size_of(4), &spill});
  fill(store, 3);
  ASSERT_TRUE(store.pin(SubmapId{0}).has_value());
  ASSERT_TRUE(store.add({3}, wall(3)).has_value());  // instead of 1
  ASSERT_TRUE(store.pin(SubmapId{0}).has_value());
  ASSERT_TRUE(store.pin(SubmapId{2}).has_value());
  EXPECT_EQ(spill.reads(), 0U);
  ASSERT_TRUE(store.pin(SubmapId{1}).has_value());
  EXPECT_EQ(spill.reads(), 1U);
}

// A search grows while it is asked. Where all submaps fit when they come, nobody comes for whom room had to be made.
TEST(SubmapStore, WhatGrewBeyondTheLimitGoesOutWithoutAnyoneComing) {
  MemorySpill spill;
  SubmapStore store(3, {}, {size_of(0) + size_of(1) + size_of(2) + 3000, &spill});
  fill(store, 3);
  for (int i = 0; i < 3; ++i) {
    const auto map = store.pin(SubmapId{i});
    ASSERT_TRUE(map.has_value());
    const NearestVoxelField* field = (*map)->by_centroid().field();
    ASSERT_NE(field, nullptr);
    for (int x = -8; x < 8; ++x) (void)field->near({0.1 * x, 1.0, 1.0});
    ASSERT_GT((*map)->bytes(), size_of(i) + 3000);
  }
  EXPECT_GT(spill.written(), 0U);
}

// Room for one pair and a bit, eight threads that want one each: they take turns.
TEST(SubmapStore, ManyThreadsGetAlongWithRoomForOnePair) {
  constexpr int kSubmaps = 9;
  MemorySpill spill;
  SubmapStore store(kSubmaps, {}, {size_of(kSubmaps - 1) + size_of(kSubmaps - 2), &spill});
  fill(store, kSubmaps);
  std::atomic<int> right = 0;
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 8; ++t) {
      threads.emplace_back([&, t] {
        for (int k = 0; k < 40; ++k) {
          const int a = (t + k) % kSubmaps;
          const int b = (t + 5 * k + 1) % kSubmaps;
          if (a == b) continue;
          const auto pair = store.pin(PairId{{a}, {b}});
          if (!pair) return;
          if (pair->source->map().voxels().size() != wall(a).voxels().size()) return;
          if (pair->target->by_centroid().map().voxels().size() != wall(b).voxels().size()) return;
        }
        ++right;
      });
    }
  }
  EXPECT_EQ(right, 8);
}

TEST(SubmapStore, APairBeyondTheLimitIsRefused) {
  MemorySpill spill;
  SubmapStore store(3, {}, {size_of(2) + size_of(0) / 2, &spill});
  fill(store, 3);
  const auto pair = store.pin(PairId{{2}, {1}});
  ASSERT_FALSE(pair.has_value());
  EXPECT_EQ(pair.error().code, ErrorCode::kOutOfMemory);
  EXPECT_EQ(store.pin(SubmapId{0}).error().code, ErrorCode::kOutOfMemory) << "a failure stays";
}

TEST(SubmapStore, WithoutSpillSpaceAllMustFit) {
  SubmapStore store(3, {}, {2 * size_of(3), nullptr});
  fill(store, 2);
  const auto refused = store.add({2}, wall(2));
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, ErrorCode::kOutOfMemory);
  const std::size_t all = size_of(0) + size_of(1) + size_of(2);
  EXPECT_EQ(refused.error().message,
            exceeds_memory("submaps that must be in memory together need at least", all, 2 * size_of(3)).message);
}

TEST(SubmapStore, WithoutSpillSpaceWhatGrewIsToldWithItsSize) {
  SubmapStore store(2, {}, {size_of(0) + size_of(1) + 3000, nullptr});
  fill(store, 2);
  std::size_t all = size_of(1);
  {
    const auto map = store.pin(SubmapId{0});
    for (int x = -8; x < 8; ++x) (void)(*map)->by_centroid().field()->near({0.1 * x, 1.0, 1.0});
    all += (*map)->bytes();
  }
  const auto refused = store.pin(SubmapId{1});
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().message,
            exceeds_memory("submaps that must be in memory together need at least", all, size_of(0) + size_of(1) + 3000)
                .message);
}

// Runs what asks for memory with 0, 1, 2 ... blocks to be had, until it has enough. \return how often it had not.
std::size_t starve(const std::function<bool(std::size_t blocks)>& attempt) {
  for (std::size_t blocks = 0; blocks < 100'000; ++blocks) {
    if (attempt(blocks)) return blocks;
  }
  ADD_FAILURE() << "never enough";
  return 0;
}

// Whether `act` came to its end with that many blocks.
bool has_enough(std::size_t blocks, const std::function<void()>& act) {
  kilter_testing::allocations_left() = blocks;
  bool enough = true;
  try {
    act();
  } catch (const std::bad_alloc&) {
    enough = false;
  }
  kilter_testing::allocations_left() = std::numeric_limits<std::size_t>::max();
  return enough;
}

// Whether another thread that asks for the map is answered, one way or the other.
bool answers_others(const std::shared_ptr<SubmapStore>& store, SubmapId id) {
  auto asked = std::make_shared<std::promise<void>>();
  std::future<void> answered = asked->get_future();
  // Alone with what it uses, for it may wait for ever.
  std::thread([store, id, asked] {
    (void)store->pin(id);
    asked->set_value();
  }).detach();
  return answered.wait_for(std::chrono::seconds(20)) == std::future_status::ready;
}

TEST(SubmapStoreWithoutMemory, AddsAllOrNothing) {
  const std::size_t tries = starve([](std::size_t blocks) {
    MemorySpill spill;
    SubmapStore store(2, {}, {size_of(1) + 10, &spill});
    VoxelMap map = wall(0);
    const bool enough = has_enough(blocks, [&] { (void)store.add({0}, std::move(map)); });
    EXPECT_TRUE(enough || store.add({0}, wall(0)).has_value());
    EXPECT_TRUE(store.add({1}, wall(1)).has_value());  // for which the first goes out
    EXPECT_EQ(spill.written(), 1U);
    return enough;
  });
  EXPECT_GT(tries, 2U);
}

TEST(SubmapStoreWithoutMemory, NobodyWaitsForWhatADisappointedThreadWasToBring) {
  const std::size_t tries = starve([](std::size_t blocks) {
    const auto spill = std::make_shared<MemorySpill>();
    const std::shared_ptr<SubmapStore> store(new SubmapStore(3, {}, {size_of(1) + size_of(2) + 10, spill.get()}),
                                             [spill](const SubmapStore* gone) { delete gone; });
    fill(*store, 3);  // 0 is out, and 1 or 2 has to go for it
    bool got = false;
    const bool enough = has_enough(blocks, [&] { got = store->pin(PairId{{0}, {1}}).has_value(); });
    EXPECT_TRUE(answers_others(store, {0})) << "after " << blocks << " blocks";
    return ::testing::Test::HasFailure() || (enough && got);
  });
  EXPECT_GT(tries, 5U);
}

TEST(SubmapStoreWithoutMemory, APinIsLetGo) {
  MemorySpill spill;
  SubmapStore store(2, {}, {size_of(1) + 10, &spill});
  fill(store, 1);
  std::optional<PinnedMap> map(*store.pin(SubmapId{0}));
  EXPECT_TRUE(has_enough(0, [&] { map.reset(); }));
  EXPECT_TRUE(store.add({1}, wall(1)).has_value());
  EXPECT_EQ(spill.written(), 1U);
}

TEST(SubmapStore, SaysThatTheDiskIsFullAndThatBytesCameBackWrong) {
  MemorySpill full;
  full.refuse_writes({ErrorCode::kNoSpace, "full", "/somewhere", {}});
  SubmapStore one(3, {}, {2 * size_of(3), &full});
  fill(one, 2);
  const auto refused = one.add({2}, wall(2));
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, ErrorCode::kNoSpace);
  EXPECT_EQ(refused.error().where, "/somewhere");
  EXPECT_NE(refused.error().hint.find("TMPDIR"), std::string::npos);

  MemorySpill damaged;
  SubmapStore two(3, {}, {2 * size_of(3), &damaged});
  fill(two, 3);
  damaged.flip_a_bit();
  EXPECT_EQ(two.pin(SubmapId{0}).error().code, ErrorCode::kOutOfMemory);
}

}  // namespace
}  // namespace kilter
