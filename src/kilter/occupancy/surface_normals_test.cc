// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/occupancy/surface_normals.h"

#include <gtest/gtest.h>

#include "kilter/base/rng.h"
#include "kilter/occupancy/map_builder.h"

namespace kilter {
namespace {

TEST(SurfaceNormals, PlaneGivesItsNormalTowardsTheSensor) {
  Rng rng(1, 0);
  const Eigen::Vector3d normal = Eigen::Vector3d(0.2, -0.3, 1.0).normalized();
  const Eigen::Vector3d u = normal.unitOrthogonal();
  const Eigen::Vector3d v = normal.cross(u);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 20000; ++i) {
    points.push_back(u * rng.uniform(-2, 2) + v * rng.uniform(-2, 2) + normal * 0.01 * rng.normal());
  }
  MapBuilder builder({.resolution_m = 0.1, .min_range_m = 0.0});
  builder.insert_scan(points, normal * 3.0);
  const VoxelMap map = builder.finish();
  double worst = 1.0;
  int checked = 0;
  for (std::size_t i = 0; i < map.voxels().size(); ++i) {
    if (map.voxels().centroids_m[i].norm() > 1.5F) continue;
    worst = std::min(worst, static_cast<double>(map.voxels().normals[i].dot(normal.cast<float>())));
    EXPECT_GT(map.voxels().planarity[i], 0.5F);
    ++checked;
  }
  EXPECT_GT(checked, 500);
  EXPECT_GT(worst, 0.98);
}

TEST(SurfaceNormals, LinesAndLonePointsHaveNone) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 100; ++i) points.emplace_back(0.1 * i + 0.05, 0.05, 0.05);
  points.emplace_back(0.05, 50.0, 0.05);
  MapBuilder builder({.resolution_m = 0.1});
  builder.insert_points(points);
  const VoxelMap map = builder.finish();
  for (const Eigen::Vector3f& normal : map.voxels().normals) EXPECT_EQ(normal.norm(), 0.0F);
}

}  // namespace
}  // namespace kilter
