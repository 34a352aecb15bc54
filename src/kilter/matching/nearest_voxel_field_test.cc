// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/nearest_voxel_field.h"

#include <gtest/gtest.h>

#include <limits>
#include <tuple>

#include "kilter/base/parallel.h"
#include "kilter/base/rng.h"
#include "kilter/matching/nearest_voxel.h"
#include "kilter/occupancy/map_builder.h"

namespace kilter {
namespace {

VoxelMap map_of(const std::vector<Eigen::Vector3d>& points_m, double resolution_m) {
  MapBuilder builder({.resolution_m = resolution_m});
  builder.insert_points(points_m);
  return builder.finish();
}

Eigen::Vector3d random_point(Rng& rng, const Eigen::Vector3d& middle_m, double spread_m) {
  const double x = rng.uniform(-spread_m, spread_m);
  const double y = rng.uniform(-spread_m, spread_m);
  return middle_m + Eigen::Vector3d(x, y, rng.uniform(-1.0, 1.0));
}

VoxelMap random_map(double resolution_m, const Eigen::Vector3d& middle_m = Eigen::Vector3d::Zero()) {
  Rng rng(11, 0);
  std::vector<Eigen::Vector3d> points_m;
  for (int i = 0; i < 300; ++i) points_m.push_back(random_point(rng, middle_m, 4.0));
  return map_of(points_m, resolution_m);
}

// By looking at all of them.
std::uint32_t nearest_centre(const VoxelMap& map, const VoxelIndex& cell, double reach_m) {
  const int reach = static_cast<int>(std::ceil(reach_m / map.resolution_m() + std::sqrt(3.0)));
  std::tuple<int, int, int, int> least{reach * reach + 1, std::numeric_limits<int>::lowest(), 0, 0};
  std::uint32_t nearest = kNoVoxel;
  for (std::size_t i = 0; i < map.indices().size(); ++i) {
    const VoxelIndex& at = map.indices()[i];
    const std::tuple<int, int, int, int> found{(at - cell).squaredNorm(), at.z(), at.y(), at.x()};
    if (!(found < least)) continue;
    least = found;
    nearest = static_cast<std::uint32_t>(i);
  }
  return nearest;
}

TEST(NearestVoxelField, NamesTheVoxelWhoseCentreIsNearestToTheCellsOnEveryPath) {
  for (const auto& [resolution_m, reach_m] : {std::tuple(0.1, 1.0), std::tuple(0.25, 2.0), std::tuple(0.05, 1.1)}) {
    for (const Eigen::Vector3d& middle_m : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(-54321.0, 12345.0, -300.0)}) {
      const VoxelMap map = random_map(resolution_m, middle_m);
      for (const VectorPath path : vector_paths()) {
        const NearestVoxelField field(map, reach_m, path);
        Rng rng(7, 3);
        int found = 0;
        for (int k = 0; k < 1500; ++k) {
          const Eigen::Vector3d at_m = random_point(rng, middle_m, 6.5);
          const std::uint32_t expected = nearest_centre(map, voxel_at(at_m, resolution_m), reach_m);
          ASSERT_EQ(field.near(at_m), expected) << at_m.transpose() << " at " << resolution_m;
          found += expected == kNoVoxel ? 0 : 1;
        }
        EXPECT_GT(found, 200);
        EXPECT_LT(found, 1500);
      }
    }
  }
}

TEST(NearestVoxelField, OfEquallyNearVoxelsTheLowestZThenYThenXIsNamed) {
  const VoxelMap map = map_of({{0.05, 0.05, 0.25}, {0.05, 0.45, 0.25}, {0.25, 0.25, 0.45}, {0.45, 0.05, 0.25}}, 0.1);
  const NearestVoxelField field(map, 1.0);
  EXPECT_EQ(map.indices()[field.near({0.25, 0.05, 0.25})], VoxelIndex(0, 0, 2));
  EXPECT_EQ(map.indices()[field.near({0.25, 0.25, 0.25})], VoxelIndex(2, 2, 4));
  EXPECT_EQ(map.indices()[field.near({0.05, 0.25, 0.25})], VoxelIndex(0, 0, 2));
}

TEST(NearestVoxelField, LosesNothingWithinReachAndIsNeverTwoDiagonalsFarther) {
  const double resolution_m = 0.1;
  const double reach_m = 1.0;
  const VoxelMap map = random_map(resolution_m);
  const NearestVoxelField field(map, reach_m);
  const NearestVoxelSearch search(map, VoxelPosition::kCentroid, reach_m);
  Rng rng(9, 1);
  int within = 0;
  for (int k = 0; k < 3000; ++k) {
    const Eigen::Vector3d at_m = random_point(rng, {0, 0, 0}, 5.0);
    const auto nearest = search.nearest(at_m, reach_m);
    if (!nearest) continue;
    ++within;
    const std::uint32_t near = field.near(at_m);
    ASSERT_NE(near, kNoVoxel);
    const double distance_m = (map.voxels().centroids_m[near].cast<double>() - at_m).norm();
    EXPECT_GE(distance_m, nearest->distance_m - 1e-6);
    EXPECT_LT(distance_m, nearest->distance_m + 2.0 * std::sqrt(3.0) * resolution_m);
  }
  EXPECT_GT(within, 1000);
}

TEST(NearestVoxelField, ThreadsThatBuildItTogetherFindTheSame) {
  const VoxelMap map = random_map(0.1);
  const NearestVoxelField alone(map, 1.0);
  const NearestVoxelField shared(map, 1.0);
  std::vector<std::uint32_t> found(4000);
  const auto point_of = [](std::size_t k) {
    Rng rng(21, k / 4);  // the same points for neighbouring numbers
    return random_point(rng, {0, 0, 0}, 5.0);
  };
  parallel_for(found.size(), {.threads = 4}, [&](std::size_t k) { found[k] = shared.near(point_of(k)); });
  for (std::size_t k = 0; k < found.size(); ++k) ASSERT_EQ(found[k], alone.near(point_of(k)));
  EXPECT_EQ(shared.bytes(), alone.bytes());
  EXPECT_GT(shared.bytes(), 0U);
}

TEST(NearestVoxelField, FitsWhereReachAndBoxAreSmall) {
  EXPECT_TRUE(NearestVoxelField::fits(random_map(0.1), 1.0));
  EXPECT_TRUE(NearestVoxelField::fits(random_map(0.1), 2.2));
  EXPECT_FALSE(NearestVoxelField::fits(random_map(0.1), 2.4));
  EXPECT_FALSE(NearestVoxelField::fits(map_of({{-500, -500, 0}, {500, 500, 10}}, 0.1), 1.0));
  const VoxelMap nothing = MapBuilder({.resolution_m = 0.1}).finish();
  ASSERT_TRUE(NearestVoxelField::fits(nothing, 1.0));
  EXPECT_EQ(NearestVoxelField(nothing, 1.0).near({0, 0, 0}), kNoVoxel);
}

}  // namespace
}  // namespace kilter
