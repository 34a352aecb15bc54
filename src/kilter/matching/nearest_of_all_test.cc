// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/nearest_of_all.h"

#include <gtest/gtest.h>

#include "kilter/base/rng.h"
#include "kilter/occupancy/map_builder.h"

namespace kilter {
namespace {

// A floor and two walls with things in between, seen a little differently by each seed.
VoxelMap room(std::uint64_t seed, double resolution_m, int points) {
  Rng rng(seed, 0);
  std::vector<Eigen::Vector3d> cloud;
  for (int i = 0; i < points; ++i) {
    const double a = rng.uniform(-4.0, 4.0);
    const double b = rng.uniform(0.0, 3.0);
    const double noise = rng.uniform(-0.02, 0.02);
    switch (i % 4) {
      case 0:
        cloud.emplace_back(a, 2.0 * b - 3.0, noise);
        break;
      case 1:
        cloud.emplace_back(a, 3.0 + noise, b);
        break;
      case 2:
        cloud.emplace_back(-4.0 + noise, 2.0 * b - 3.0, std::abs(a));
        break;
      default:
        cloud.emplace_back(a, 2.0 * b - 3.0, 0.4 * std::abs(a));
        break;
    }
  }
  MapBuilder builder({.resolution_m = resolution_m});
  builder.insert_points(cloud);
  return builder.finish();
}

Pose3 pose(const Eigen::Vector3d& translation_m, double angle_rad, const Eigen::Vector3d& axis) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, axis.normalized())), translation_m};
}

void expect_same(const NearestVoxelSearch& source, const NearestVoxelSearch& target, const Pose3& T, double limit_m) {
  NearestVoxelCursor cursor(target);
  std::vector<std::optional<NearestVoxel>> expected;
  for (std::size_t i = 0; i < source.map().voxels().size(); ++i) {
    expected.push_back(cursor.nearest(T.isometry() * voxel_position_m(source.map(), i, source.position()), limit_m));
  }
  for (const VectorPath path : vector_paths()) {
    const std::vector<NearestVoxel> found = nearest_of_all(source, target, T, limit_m, path);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      ASSERT_EQ(found[i].voxel, expected[i] ? expected[i]->voxel : kNoVoxel)
          << "voxel " << i << ", path " << static_cast<int>(path) << ", limit " << limit_m;
      if (expected[i]) {
        ASSERT_EQ(found[i].distance_m, expected[i]->distance_m);
      }
    }
  }
}

TEST(NearestOfAll, IsWhatEachVoxelFindsAlone) {
  for (const double resolution_m : {0.1, 0.25}) {
    const VoxelMap source = room(1, resolution_m, 9000);
    const VoxelMap target = room(2, resolution_m, 7000);
    for (const VoxelPosition position : {VoxelPosition::kCentre, VoxelPosition::kCentroid}) {
      const NearestVoxelSearch from(source, position, 2.5);
      const NearestVoxelSearch onto(target, position, 2.5);
      const std::vector<Pose3> poses = {Pose3(), pose({0.15, -0.1, 0.05}, 0.02, {0, 0, 1}),
                                        pose({1.0, 2.0, 0.5}, 1.1, {0.1, 0.3, 1}), pose({40.0, 0, 0}, 0, {0, 0, 1})};
      for (const Pose3& T : poses) {
        for (const double limit_m : {0.05, 0.2, 1.0, 2.5}) expect_same(from, onto, T, limit_m);
      }
    }
  }
}

// Where floats are eight millimetres apart.
TEST(NearestOfAll, FarFromTheOriginToo) {
  const Pose3 away = Pose3::from_translation(110000.0, -90000.0, 300.0);
  std::vector<VoxelMap> maps;
  for (const std::uint64_t seed : {5U, 6U}) {
    std::vector<Eigen::Vector3d> cloud;
    const VoxelMap near = room(seed, 0.1, 9000);
    for (const Eigen::Vector3f& point_m : near.voxels().centroids_m) {
      cloud.push_back(away * point_m.cast<double>());
    }
    MapBuilder builder({.resolution_m = 0.1});
    builder.insert_points(cloud);
    maps.push_back(builder.finish());
  }
  const NearestVoxelSearch from(maps[0], VoxelPosition::kCentroid, 1.0);
  const NearestVoxelSearch onto(maps[1], VoxelPosition::kCentroid, 1.0);
  for (double x_m = 0.2; x_m < 1.3; x_m += 0.1) {
    const Pose3 moved = pose({0.0, 0.0, x_m}, 0.0, {0.0, 0.0, 1.0});
    expect_same(from, onto, away * moved * away.inverse(), 1.0);
  }
}

// On one lattice most voxels have several others equally near.
TEST(NearestOfAll, TiesGoToTheLowerVoxel) {
  const VoxelMap source = room(3, 0.25, 5000);
  const VoxelMap target = room(4, 0.25, 500);
  const NearestVoxelSearch from(source, VoxelPosition::kCentre, 2.0);
  const NearestVoxelSearch onto(target, VoxelPosition::kCentre, 2.0);
  for (const Eigen::Vector3d& shift_m : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.125, 0, 0.125)}) {
    expect_same(from, onto, pose(shift_m, 0.0, {0, 0, 1}), 2.0);
  }
}

// Whatever the search sets out from: what the last pose found, then any voxels at all.
TEST(NearestOfAll, IsTheSameWhereverItBegins) {
  const VoxelMap source = room(1, 0.1, 9000);
  const VoxelMap target = room(2, 0.1, 7000);
  Rng rng(3, 0);
  for (const VoxelPosition position : {VoxelPosition::kCentre, VoxelPosition::kCentroid}) {
    const NearestVoxelSearch from(source, position, 1.0);
    const NearestVoxelSearch onto(target, position, 1.0);
    for (const VectorPath path : vector_paths()) {
      std::vector<NearestVoxel> found(source.voxels().size(), NearestVoxel{kNoVoxel, 0.0});
      for (int k = 0; k < 12; ++k) {
        const Pose3 T = pose({0.1 * k, -0.04 * k, 0.03 * k}, 0.01 * k, {0, 0.2, 1});
        const double limit_m = k % 3 == 2 ? 0.15 : 1.0;
        if (k > 8) {
          for (NearestVoxel& each : found) each.voxel = static_cast<std::uint32_t>(rng.bits() % target.voxels().size());
        }
        nearest_of_all_again(from, onto, T, limit_m, found, path);
        const std::vector<NearestVoxel> expected = nearest_of_all(from, onto, T, limit_m, path);
        for (std::size_t i = 0; i < found.size(); ++i) {
          ASSERT_EQ(found[i].voxel, expected[i].voxel) << "voxel " << i << ", pose " << k;
          ASSERT_EQ(found[i].distance_m, expected[i].distance_m);
        }
      }
    }
  }
}

// A robot whose poses jump that far is asked for all the same.
TEST(NearestOfAll, WhatIsHalfwayRoundTheWorldIsNotSearchedFor) {
  const VoxelMap source = room(1, 0.1, 9000);
  const VoxelMap target = room(2, 0.1, 7000);
  const NearestVoxelSearch from(source, VoxelPosition::kCentroid, 1.0);
  const NearestVoxelSearch onto(target, VoxelPosition::kCentroid, 1.0);
  for (const NearestVoxel& each : nearest_of_all(from, onto, Pose3::from_translation(2e8, -2e8, 2e8), 1.0)) {
    ASSERT_EQ(each.voxel, kNoVoxel);
  }
}

TEST(NearestOfAll, EmptyMapsHaveNothingNear) {
  const VoxelMap full = room(1, 0.1, 500);
  const VoxelMap empty = MapBuilder({.resolution_m = 0.1}).finish();
  const NearestVoxelSearch of_full(full, VoxelPosition::kCentroid, 1.0);
  const NearestVoxelSearch of_empty(empty, VoxelPosition::kCentroid, 1.0);
  EXPECT_TRUE(nearest_of_all(of_empty, of_full, Pose3(), 1.0).empty());
  std::vector<NearestVoxel> found = nearest_of_all(of_full, of_empty, Pose3(), 1.0);
  for (const NearestVoxel& each : found) EXPECT_EQ(each.voxel, kNoVoxel);
  nearest_of_all_again(of_full, of_empty, Pose3(), 1.0, found);
  for (const NearestVoxel& each : found) EXPECT_EQ(each.voxel, kNoVoxel);
}

}  // namespace
}  // namespace kilter
