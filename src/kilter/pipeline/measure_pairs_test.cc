// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/pipeline/measure_pairs.h"

#include <gtest/gtest.h>

#include <vector>

#include "kilter/occupancy/map_builder.h"
#include "testing/allocation_watch.h"

namespace kilter {
namespace {

// Two walls that are one, and a third four metres behind them.
class ThreeWalls : public ::testing::Test {
 protected:
  ThreeWalls() : nodes_(3), store_(3, search_setup(options_), {}) {
    std::vector<Eigen::Vector3d> points;
    for (int y = 0; y < 30; ++y) {
      for (int z = 0; z < 20; ++z) points.emplace_back(0.31, 0.1 * y + 0.03, 0.1 * z + 0.04);
    }
    for (int i = 0; i < 3; ++i) {
      MapBuilder builder({.resolution_m = 0.1});
      builder.insert_points(points);
      EXPECT_TRUE(store_.add({i}, builder.finish()).has_value());
      nodes_[static_cast<std::size_t>(i)].id = {i};
      nodes_[static_cast<std::size_t>(i)].T_world_submap = Pose3::from_translation(i == 2 ? 4.0 : 0.0, 0.0, 0.0);
    }
  }

  Expected<MeasuredPairs> measure(const std::vector<CandidatePair>& candidates, int threads) {
    return measure_pairs(nodes_, candidates, options_, store_, {.threads = threads});
  }

  CheckOptions options_ = resolved({});
  std::vector<SubmapNode> nodes_;
  SubmapStore store_;
};

// Every hundredth shows one wall, the others show two.
std::vector<CandidatePair> mostly_hopeless(int count) {
  std::vector<CandidatePair> candidates;
  for (int i = 0; i < count; ++i) {
    CandidatePair pair;
    pair.id = {{i % 100 == 50 ? 1 : 2}, {0}};
    pair.kind = PairKind::kGlobal;
    pair.drift_allowance_m = i;
    candidates.push_back(pair);
  }
  return candidates;
}

TEST_F(ThreeWalls, WhatIsListedKeepsTheCandidatesOrder) {
  for (const int threads : {1, 3}) {
    const Expected<MeasuredPairs> pairs = measure(mostly_hopeless(300), threads);
    ASSERT_TRUE(pairs.has_value());
    EXPECT_EQ(pairs->left_out, 297U);
    ASSERT_EQ(pairs->listed.size(), 3U);
    for (std::size_t k = 0; k < 3; ++k) {
      const PairMeasurement& pair = pairs->listed[k];
      EXPECT_EQ(pair.candidate.drift_allowance_m, 100.0 * static_cast<double>(k) + 50.0);
      EXPECT_EQ(pair.evidence.id, (PairId{{1}, {0}}));
      EXPECT_TRUE(pair.evidence.overlaps);
      EXPECT_EQ(pair.evidence.map.mean_distance_m, pairs->listed[0].evidence.map.mean_distance_m);
    }
  }
}

// A thousand submaps of one building meet a million times, and a few thousand of these are worth a measurement.
TEST_F(ThreeWalls, ACandidateThatIsNotListedTakesNoRoom) {
  constexpr std::size_t kCount = 3000;
  const std::vector<CandidatePair> candidates = mostly_hopeless(kCount);
  ASSERT_TRUE(measure({candidates[50]}, 1).has_value());  // the store's searches have grown to what they become
  kilter_testing::largest_allocation() = 0;
  const Expected<MeasuredPairs> pairs = measure(candidates, 1);
  EXPECT_LT(kilter_testing::largest_allocation(), kCount * sizeof(PairMeasurement) / 10);
  ASSERT_TRUE(pairs.has_value());
  EXPECT_EQ(pairs->listed.size(), kCount / 100);
}

}  // namespace
}  // namespace kilter
