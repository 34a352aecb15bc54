// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/nearest_voxel.h"

#include <gtest/gtest.h>

#include "kilter/base/rng.h"
#include "kilter/occupancy/map_builder.h"

namespace kilter {
namespace {

VoxelMap random_map(double resolution_m, int points, double spread_m) {
  Rng rng(11, 0);
  std::vector<Eigen::Vector3d> cloud;
  for (int i = 0; i < points; ++i) {
    cloud.emplace_back(rng.uniform(-spread_m, spread_m), rng.uniform(-spread_m, spread_m), rng.uniform(-1.0, 1.0));
  }
  MapBuilder builder({.resolution_m = resolution_m});
  builder.insert_points(cloud);
  return builder.finish();
}

TEST(NearestVoxelSearch, AgreesWithBruteForceForBothPositionsAndManyLimits) {
  for (const double resolution_m : {0.1, 0.25}) {
    const VoxelMap map = random_map(resolution_m, 800, 4.0);
    for (const VoxelPosition position : {VoxelPosition::kCentre, VoxelPosition::kCentroid}) {
      const NearestVoxelSearch search(map, position, 2.5);
      Rng rng(3, 1);
      int found = 0;
      for (int k = 0; k < 1500; ++k) {
        const Eigen::Vector3d at(rng.uniform(-6, 6), rng.uniform(-6, 6), rng.uniform(-3, 3));
        const double limit_m = rng.uniform(0.05, 2.5);
        double best = limit_m;
        bool any = false;
        for (std::size_t i = 0; i < map.voxels().size(); ++i) {
          const double d = (voxel_position_m(map, i, position) - at).norm();
          if (d <= best) {
            best = d;
            any = true;
          }
        }
        const auto nearest = search.nearest(at, limit_m);
        ASSERT_EQ(nearest.has_value(), any) << at.transpose() << " limit " << limit_m;
        if (any) {
          EXPECT_NEAR(nearest->distance_m, best, 1e-6);
        }
        found += any ? 1 : 0;
      }
      EXPECT_GT(found, 300);
      EXPECT_LT(found, 1500);
    }
  }
}

TEST(NearestVoxelCursor, HintsAndMemoryChangeNoAnswer) {
  const VoxelMap map = random_map(0.1, 3000, 4.0);
  const NearestVoxelSearch search(map, VoxelPosition::kCentroid, 1.0);
  NearestVoxelCursor cursor(search);
  Rng rng(5, 2);
  int found = 0;
  for (int k = 0; k < 4000; ++k) {
    const Eigen::Vector3d at(rng.uniform(-5, 5), rng.uniform(-5, 5), rng.uniform(-2, 2));
    const double limit_m = rng.uniform(0.05, 1.0);
    const auto hint = static_cast<std::uint32_t>(rng.uniform(0.0, 1.0) * static_cast<double>(map.voxels().size()));
    const auto alone = search.nearest(at, limit_m);
    const auto hinted = cursor.nearest(at, limit_m, hint);
    ASSERT_EQ(alone.has_value(), hinted.has_value()) << at.transpose();
    if (!alone) continue;
    ++found;
    ASSERT_EQ(alone->voxel, hinted->voxel) << at.transpose();
    ASSERT_EQ(cursor.nearest(at, limit_m, alone->voxel)->voxel, alone->voxel);
  }
  EXPECT_GT(found, 500);
}

TEST(NearestVoxelSearch, TiesGoToTheLowerVoxelAndOnesOwnVoxelIsAtZero) {
  MapBuilder builder({.resolution_m = 0.25});  // a power of two, so that the tie is one in floating point too
  builder.insert_points(std::vector<Eigen::Vector3d>{{0.125, 0.125, 0.125}, {0.625, 0.125, 0.125}});
  const VoxelMap map = builder.finish();
  const NearestVoxelSearch search(map, VoxelPosition::kCentre, 1.0);
  EXPECT_EQ(search.nearest({0.375, 0.125, 0.125}, 1.0)->voxel, 0U);
  EXPECT_NEAR(search.nearest({0.625, 0.125, 0.125}, 1.0)->distance_m, 0.0, 1e-12);
  EXPECT_FALSE(search.nearest({5.0, 5.0, 5.0}, 1.0).has_value());
}

TEST(NearestVoxelSearch, EmptyMapHasNoNearest) {
  const VoxelMap map = MapBuilder({.resolution_m = 0.1}).finish();
  EXPECT_FALSE(NearestVoxelSearch(map, VoxelPosition::kCentre, 1.0).nearest({0, 0, 0}, 1.0).has_value());
}

std::optional<NearestVoxel> near_one(RepeatedSearch& search, std::uint32_t point, const Eigen::Vector3d& at_m,
                                     double limit_m) {
  PointColumns points_m;
  points_m.set(0, at_m);
  RepeatedSearch::Found found;
  search.near({&point, 1}, points_m, limit_m, found);
  if (found.voxel[0] == kNoVoxel) return std::nullopt;
  return NearestVoxel{found.voxel[0], std::sqrt(found.square_m2[0])};
}

TEST(RepeatedSearch, TakesTheFieldsWordWithinTheLimit) {
  const VoxelMap map = random_map(0.1, 3000, 4.0);
  const NearestVoxelSearch search(map, VoxelPosition::kCentroid, 1.0);
  RepeatedSearch repeated(search, 1);
  ASSERT_FALSE(repeated.exact());
  Rng rng(5, 2);
  int found = 0;
  for (int k = 0; k < 2000; ++k) {
    const Eigen::Vector3d at(rng.uniform(-5, 5), rng.uniform(-5, 5), rng.uniform(-2, 2));
    const double limit_m = rng.uniform(0.05, 1.0);
    const std::uint32_t voxel = search.field()->near(at);
    const auto near = near_one(repeated, 0, at, limit_m);
    const bool within =
        voxel != kNoVoxel && (voxel_position_m(map, voxel, VoxelPosition::kCentroid) - at).norm() <= limit_m;
    ASSERT_EQ(near.has_value(), within);
    if (!near) continue;
    ++found;
    EXPECT_EQ(near->voxel, voxel);
    EXPECT_EQ(near->distance_m, (voxel_position_m(map, voxel, VoxelPosition::kCentroid) - at).norm());
  }
  EXPECT_GT(found, 300);
}

TEST(RepeatedSearch, ManyAtOnceAreAsEachAlone) {
  const VoxelMap map = random_map(0.1, 3000, 4.0);
  const NearestVoxelSearch search(map, VoxelPosition::kCentroid, 1.0);
  RepeatedSearch repeated(search, 1);
  Rng rng(5, 3);
  std::size_t none = 0;
  std::size_t asked = 0;
  for (std::size_t count = 1; count <= PointColumns::kMost; ++count) {
    PointColumns at_m;
    for (std::size_t k = 0; k < count; ++k) at_m.set(k, {rng.uniform(-5, 5), rng.uniform(-5, 5), rng.uniform(-2, 2)});
    const std::vector<std::uint32_t> numbers(count, 0);
    RepeatedSearch::Found found;
    repeated.near(numbers, at_m, 0.4, found);
    for (std::size_t k = 0; k < count; ++k) {
      const auto alone = near_one(repeated, 0, at_m[k], 0.4);
      ASSERT_EQ(found.voxel[k], alone ? alone->voxel : kNoVoxel);
      if (alone) {
        EXPECT_EQ(std::sqrt(found.square_m2[k]), alone->distance_m);
      }
      none += alone ? 0U : 1U;
    }
    asked += count;
  }
  EXPECT_GT(none, asked / 10);
  EXPECT_LT(none, asked - asked / 10);
}

TEST(NearestVoxelSearch, CountsWhatItsFieldHoldsByNow) {
  const VoxelMap map = random_map(0.1, 800, 4.0);
  const NearestVoxelSearch search(map, VoxelPosition::kCentroid, 1.0);
  const std::size_t fresh = search.bytes();
  EXPECT_GT(fresh, map.voxels().size() * 16);
  (void)search.field()->near({0.0, 0.0, 0.0});
  EXPECT_EQ(search.bytes(), fresh + search.field()->bytes());
  EXPECT_GT(search.bytes(), fresh);
}

TEST(RepeatedSearch, IsExactWhereTheFieldWouldBeTooLarge) {
  const VoxelMap map = random_map(0.1, 800, 4.0);
  const NearestVoxelSearch search(map, VoxelPosition::kCentroid, 5.0);
  RepeatedSearch repeated(search, 10);
  ASSERT_TRUE(repeated.exact());
  EXPECT_EQ(search.field(), nullptr);
  Rng rng(5, 2);
  for (std::uint32_t k = 0; k < 500; ++k) {
    const Eigen::Vector3d at(rng.uniform(-8, 8), rng.uniform(-8, 8), rng.uniform(-2, 2));
    const auto nearest = search.nearest(at, 5.0);
    const auto near = near_one(repeated, k % 10, at, 5.0);
    ASSERT_EQ(near.has_value(), nearest.has_value());
    if (near) {
      EXPECT_EQ(near->voxel, nearest->voxel);
    }
  }
}

}  // namespace
}  // namespace kilter
