// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/conflict.h"

#include <gtest/gtest.h>

#include "kilter/occupancy/map_builder.h"

namespace kilter {
namespace {

VoxelMap wall_at(double x_m, bool with_rays) {
  std::vector<Eigen::Vector3d> points;
  for (int y = -60; y <= 60; ++y) {
    for (int z = -20; z <= 20; ++z) points.emplace_back(x_m, 0.05 * y + 0.012, 0.05 * z + 0.013);
  }
  MapBuilder builder({.resolution_m = 0.1, .min_range_m = 0.0});
  if (with_rays) {
    builder.insert_scan(points, {0.02, 0.03, 0.04});
  } else {
    builder.insert_points(points);
  }
  return builder.finish();
}

ConflictSample conflict(const VoxelMap& source, const VoxelMap& target, const Pose3& T) {
  const NearestVoxelSearch source_search(source, VoxelPosition::kCentroid, 1.0);
  const NearestVoxelSearch target_search(target, VoxelPosition::kCentroid, 1.0);
  const ConflictSample all =
      measure_conflict(source, target, T, nearest_both_ways(source_search, target_search, T, 0.2));
  NearestVoxelCursor in_source(source_search);
  NearestVoxelCursor in_target(target_search);
  const ConflictSample sampled = sample_conflict(in_source, in_target, T, 0.2, 1);
  EXPECT_EQ(all.known(), sampled.known());
  EXPECT_EQ(all.source_in_target.conflicting, sampled.source_in_target.conflicting);
  EXPECT_EQ(all.target_in_source.conflicting, sampled.target_in_source.conflicting);
  return all;
}

TEST(MeasureConflict, AgreeingWallsHaveNone) {
  const VoxelMap wall = wall_at(3.04, true);
  const ConflictSample sample = conflict(wall, wall, {});
  EXPECT_GT(sample.known(), 2000U);
  EXPECT_EQ(sample.share(), 0.0);
}

// Beyond the lattice nothing is known; block 0, which its numbers would lead to, is free.
TEST(MeasureConflict, NothingIsKnownHalfwayRoundTheWorld) {
  const VoxelMap wall = wall_at(3.04, true);
  for (const double x_m : {1.7e6, 2e8, -2e8}) {
    EXPECT_EQ(conflict(wall, wall, Pose3::from_translation(x_m, 0.0, 0.0)).known(), 0U);
  }
}

TEST(MeasureConflict, AWallInsideFreeSpaceConflictsOneWay) {
  const VoxelMap far_wall = wall_at(3.04, true);
  const VoxelMap near_wall = wall_at(2.04, true);
  const ConflictSample sample = conflict(near_wall, far_wall, {});
  EXPECT_GT(sample.source_in_target.share(), 0.5);
  EXPECT_EQ(sample.target_in_source.conflicting, 0U);  // what lies behind the near wall is unknown to it
}

TEST(MeasureConflict, PointsAloneKnowNothingToBeFree) {
  const VoxelMap points = wall_at(3.04, false);
  const ConflictSample sample = conflict(points, points, Pose3::from_translation(1.0, 0.0, 0.0));
  EXPECT_EQ(sample.known(), 0U);
  EXPECT_EQ(sample.share(), 0.0);
}

}  // namespace
}  // namespace kilter
