// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/distances.h"

#include <gtest/gtest.h>

#include <numeric>

#include "kilter/occupancy/map_builder.h"

namespace kilter {
namespace {

VoxelMap line_map(int count, double slope) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) points.emplace_back(0.1 * i + 0.05, slope * (0.1 * i + 0.05) + 0.05, 0.05);
  MapBuilder builder({.resolution_m = 0.1});
  builder.insert_points(points);
  return builder.finish();
}

DistanceSample measure(const VoxelMap& source, const NearestVoxelSearch& target, const Pose3& T_target_source,
                       const MatchingOptions& options) {
  return measure_distances({source, target.position(), target.max_distance_m()}, target, T_target_source, options);
}

TEST(MeasureDistances, IdenticalSubmapsAreAtZero) {
  const VoxelMap map = line_map(300, 0.0);
  const DistanceSample sample = measure(map, {map, VoxelPosition::kCentre, 1.0}, {}, {});
  EXPECT_EQ(sample.matched(), 300U);
  EXPECT_EQ(sample.overlap(), 1.0);
  for (const double d : sample.distances_m) EXPECT_NEAR(d, 0.0, 1e-12);
}

TEST(MeasureDistances, AParallelShiftIsEveryVoxelsDistance) {
  const VoxelMap map = line_map(300, 0.0);
  const DistanceSample sample =
      measure(map, {map, VoxelPosition::kCentre, 1.0}, Pose3::from_translation(0.0, 0.3, 0.0), {});
  for (const double d : sample.distances_m) EXPECT_NEAR(d, 0.3, 1e-12);
}

TEST(MeasureDistances, BeyondTheSearchDistanceNothingMatches) {
  const VoxelMap map = line_map(300, 0.0);
  const NearestVoxelSearch search(map, VoxelPosition::kCentre, 1.0);
  const DistanceSample near = measure(map, search, Pose3::from_translation(0.0, 0.95, 0.0), {});
  EXPECT_EQ(near.matched(), 300U);
  const DistanceSample beyond = measure(map, search, Pose3::from_translation(0.0, 1.05, 0.0), {});
  EXPECT_EQ(beyond.matched(), 0U);
  EXPECT_EQ(beyond.overlap(), 0.0);
}

// Eq. (8) with voxels of different certainty: seen ten times here, once there.
TEST(MeasureDistances, OccupancyTermIsScaledByItsWeight) {
  MapBuilder often({.resolution_m = 0.1, .min_range_m = 0.0});
  MapBuilder once({.resolution_m = 0.1, .min_range_m = 0.0});
  const std::vector<Eigen::Vector3d> wall = {{1.05, 0.05, 0.05}, {1.05, 0.15, 0.05}};
  for (int i = 0; i < 10; ++i) often.insert_scan(wall, {0.05, 0.05, 0.05});
  once.insert_scan(wall, {0.05, 0.05, 0.05});
  const VoxelMap target = often.finish();
  const VoxelMap source = once.finish();
  const NearestVoxelSearch search(target, VoxelPosition::kCentre, 1.0);
  const DistanceSample literal = measure(source, search, {}, {.occupancy_weight_m = 1.0});
  ASSERT_EQ(literal.matched(), 2U);
  EXPECT_NEAR(literal.distances_m[0], 0.971 - 0.7, 1e-5);
  const DistanceSample none = measure(source, search, {}, {.occupancy_weight_m = 0.0});
  EXPECT_NEAR(none.distances_m[0], 0.0, 1e-12);
  EXPECT_NEAR(literal.mean_occupancy_m, 0.271, 1e-5);
}

TEST(MeasureDistances, EmptySubmapsGiveAnEmptySample) {
  const VoxelMap empty = MapBuilder({.resolution_m = 0.1}).finish();
  const VoxelMap line = line_map(10, 0.0);
  EXPECT_EQ(measure(empty, {line, VoxelPosition::kCentre, 1.0}, {}, {}).matched(), 0U);
  EXPECT_EQ(measure(line, {empty, VoxelPosition::kCentre, 1.0}, {}, {}).matched(), 0U);
}

TEST(EstimateOverlap, GuessesWhatMeasuringFinds) {
  const VoxelMap line = line_map(3000, 0.0);
  const VoxelMap shorter = line_map(1200, 0.0);
  const NearestVoxelSearch search(shorter, VoxelPosition::kCentre, 1.0);
  const DistanceSample exact = measure(line, search, {}, {});
  NearestVoxelCursor cursor(search);
  const OverlapEstimate guess = estimate_overlap(line, cursor, {}, {}, 500);
  EXPECT_NEAR(guess.matched, static_cast<double>(exact.matched()), 0.05 * static_cast<double>(exact.matched()));
  EXPECT_NEAR(guess.overlap, exact.overlap(), 0.05);
  EXPECT_EQ(estimate_overlap(line, cursor, Pose3::from_translation(0.0, 5.0, 0.0), {}, 500).matched, 0.0);
}

// A floor of which the other holds a corner: rows of the lattice are as long as samples are apart, or nearly.
TEST(EstimateOverlap, IsNeverBelowWhatIsThereByMoreThanItSays) {
  const auto floor_map = [](int voxels) {
    std::vector<Eigen::Vector3d> points_m;
    for (int x = 0; x < voxels; ++x) {
      for (int y = 0; y < voxels; ++y) points_m.emplace_back(0.1 * x + 0.05, 0.1 * y + 0.05, 0.05);
    }
    MapBuilder builder({.resolution_m = 0.1});
    builder.insert_points(points_m);
    return builder.finish();
  };
  int below = 0;
  for (const int voxels : {150, 300, 350}) {
    const VoxelMap floor = floor_map(voxels);
    const NearestVoxelSearch search(floor, VoxelPosition::kCentre, 1.0);
    NearestVoxelCursor cursor(search);
    for (const double corner_m : {1.0, 2.5, 4.0, 6.0}) {
      for (const double aside_m : {0.0, 0.3}) {
        const Pose3 T = Pose3::from_translation(0.1 * voxels - corner_m, 0.1 * voxels - corner_m - aside_m, 0.0);
        const DistanceSample exact = measure(floor, search, T, {});
        const OverlapEstimate guess = estimate_overlap(floor, cursor, T, {}, 500);
        below += guess.matched_at_most < static_cast<double>(exact.matched());
        below += guess.overlap_at_most < exact.overlap();
        EXPECT_LE(guess.matched, guess.matched_at_most);
        EXPECT_LT(guess.matched_at_most, 2.5 * static_cast<double>(exact.matched()) + 200.0);
      }
    }
  }
  EXPECT_EQ(below, 0);
}

TEST(EstimateOverlap, OfFewVoxelsIsWhatMeasuringFinds) {
  const VoxelMap line = line_map(300, 0.0);
  const NearestVoxelSearch search(line, VoxelPosition::kCentre, 1.0);
  NearestVoxelCursor cursor(search);
  const Pose3 T = Pose3::from_translation(21.03, 0.4, 0.0);
  const DistanceSample exact = measure(line, search, T, {});
  const OverlapEstimate guess = estimate_overlap(line, cursor, T, {}, 500);
  EXPECT_EQ(guess.matched, static_cast<double>(exact.matched()));
  EXPECT_EQ(guess.matched_at_most, guess.matched);
  EXPECT_EQ(guess.overlap, exact.overlap());
  const OverlapEstimate apart = estimate_overlap(line, cursor, Pose3::from_translation(0.0, 50.0, 0.0), {}, 500);
  EXPECT_EQ(apart.matched_at_most, 0.0);
  EXPECT_EQ(apart.overlap_at_most, 0.0);
}

// Figure 3a: two straight lines that meet at their start.
TEST(MeasureDistances, LinesThatMeetAtAnAngleGiveUniformDistances) {
  const VoxelMap target = line_map(120, 0.0);
  const VoxelMap source = line_map(100, 0.1);
  MatchingOptions options;
  options.position = VoxelPosition::kCentroid;
  const DistanceSample sample = measure(source, {target, VoxelPosition::kCentroid, 1.0}, {}, options);
  ASSERT_EQ(sample.matched(), source.voxels().size());
  const double n = static_cast<double>(sample.matched());
  const double mean = std::accumulate(sample.distances_m.begin(), sample.distances_m.end(), 0.0) / n;
  double squares = 0.0;
  for (const double d : sample.distances_m) squares += (d - mean) * (d - mean) / n;
  EXPECT_NEAR(mean, 0.5, 0.01);
  EXPECT_NEAR(squares, 1.0 / 12.0, 0.002);
}

}  // namespace
}  // namespace kilter
