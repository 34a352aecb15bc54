// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/occupancy/surface_normals.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <tuple>
#include <utility>
#include <vector>

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

// Covariance of the centroids of all voxels at most `radius` away on each axis, by looking at every voxel.
std::pair<int, Eigen::Matrix3d> covariance_by_hand(const VoxelMap& map, std::size_t i, int radius) {
  std::vector<Eigen::Vector3d> near_m;
  for (std::size_t j = 0; j < map.voxels().size(); ++j) {
    if ((map.indices()[j] - map.indices()[i]).cwiseAbs().maxCoeff() > radius) continue;
    near_m.emplace_back(map.voxels().centroids_m[j].cast<double>());
  }
  Eigen::Vector3d mean_m = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : near_m) mean_m += p / static_cast<double>(near_m.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : near_m) covariance += (p - mean_m) * (p - mean_m).transpose();
  return {static_cast<int>(near_m.size()), covariance};
}

TEST(SurfaceNormals, AreTheEigenvectorsOfTheCentroidsAround) {
  Rng rng(5, 0);
  std::vector<Eigen::Vector3d> points;  // two walls with a gap of a voxel, a floor, and loose points; far from zero
  const Eigen::Vector3d corner(-97.3, 51.2, 8.03);
  for (int i = 0; i < 3000; ++i) {
    points.push_back(corner + Eigen::Vector3d(rng.uniform(0, 2), rng.uniform(0, 2), 0.02 * rng.normal()));
    points.push_back(corner + Eigen::Vector3d(rng.uniform(0, 2), 0.03 * rng.normal(), rng.uniform(0, 1)));
    points.push_back(corner + Eigen::Vector3d(rng.uniform(0, 2), 0.15 + 0.01 * rng.normal(), rng.uniform(0, 1)));
    if (i % 30 == 0) points.push_back(corner + 2.0 * Eigen::Vector3d(rng.uniform(), rng.uniform(), rng.uniform()));
  }
  MapBuilder builder({.resolution_m = 0.1});
  builder.insert_points(points);
  const VoxelMap map = builder.finish();
  int checked = 0;
  int far = 0;
  for (std::size_t i = 0; i < map.voxels().size(); ++i) {
    auto [count, covariance] = covariance_by_hand(map, i, 2);
    if (count < 8) {
      std::tie(count, covariance) = covariance_by_hand(map, i, 4);
      ++far;
    }
    if (count < 5) {
      EXPECT_EQ(map.voxels().normals[i].norm(), 0.0F);
      continue;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
    const Eigen::Vector3d spread = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
    EXPECT_NEAR(map.voxels().planarity[i], (spread[1] - spread[0]) / spread[2], 0.005);
    if (spread[0] > 0.9 * spread[1]) continue;  // hardly a direction
    const Eigen::Vector3d normal = map.voxels().normals[i].cast<double>();
    EXPECT_NEAR(normal.norm(), 1.0, 1e-6);
    EXPECT_GT(std::abs(normal.dot(solver.eigenvectors().col(0))), 0.9995) << i;
    ++checked;
  }
  EXPECT_GT(checked, 800);
  EXPECT_GT(far, 10);
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
