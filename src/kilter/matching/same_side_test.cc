// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/same_side.h"

#include <gtest/gtest.h>

#include "kilter/occupancy/map_builder.h"

namespace kilter {
namespace {

// A slab's face at x = `x_m`, seen by a sensor at x = `from_m`.
VoxelMap face_at(double x_m, double from_m, bool with_rays = true) {
  std::vector<Eigen::Vector3d> points;
  for (int y = -60; y <= 60; ++y) {
    for (int z = -20; z <= 20; ++z) points.emplace_back(x_m, 0.05 * y + 0.012, 0.05 * z + 0.013);
  }
  MapBuilder builder({.resolution_m = 0.1, .min_range_m = 0.0});
  if (with_rays) {
    builder.insert_scan(points, {from_m, 0.03, 0.04});
  } else {
    builder.insert_points(points);
  }
  return builder.finish();
}

SameSide same_side(const VoxelMap& source, const VoxelMap& target, double max_distance_m) {
  const NearestVoxelSearch source_search(source, VoxelPosition::kCentroid, 1.0);
  const NearestVoxelSearch target_search(target, VoxelPosition::kCentroid, 1.0);
  return count_same_side(source, target, {}, nearest_both_ways(source_search, target_search, {}, max_distance_m));
}

TEST(CountSameSide, AFaceIsItsOwn) {
  const VoxelMap wall = face_at(3.04, 0.02);
  const SameSide same = same_side(wall, wall, 0.2);
  EXPECT_EQ(same.forward, wall.voxels().size());
  EXPECT_EQ(same.backward, wall.voxels().size());
}

TEST(CountSameSide, TheOtherFaceOfASlabIsNot) {
  const VoxelMap front = face_at(3.04, 0.02);
  const VoxelMap back = face_at(3.14, 6.02);
  ASSERT_GT(front.voxels().size(), 1000U);
  EXPECT_EQ(same_side(front, back, 0.2).forward, 0U);
  EXPECT_EQ(same_side(front, back, 0.2).backward, 0U);
}

TEST(CountSameSide, NorIsWhatLiesFartherAway) {
  const VoxelMap near = face_at(3.04, 0.02);
  const VoxelMap far = face_at(3.54, 0.02);
  EXPECT_EQ(same_side(near, far, 0.2).forward, 0U);
  EXPECT_EQ(same_side(near, far, 0.6).forward, near.voxels().size());
}

TEST(CountSameSide, PointsAloneHaveNoSides) {
  const VoxelMap front = face_at(3.04, 0.02, false);
  const VoxelMap back = face_at(3.14, 6.02, false);
  EXPECT_EQ(same_side(front, back, 0.2).forward, front.voxels().size());
}

}  // namespace
}  // namespace kilter
