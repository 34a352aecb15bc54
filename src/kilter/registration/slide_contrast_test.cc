// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/slide_contrast.h"

#include <gtest/gtest.h>

#include "kilter/occupancy/map_builder.h"
#include "testing/scenes.h"

namespace kilter {
namespace {

using testing::pose_at;
using testing::Scene;
using testing::submap_of;
using testing::SubmapPair;

// Two submaps of a scene, three metres apart along x.
SubmapPair pair_in(const Scene& scene) {
  const std::vector<Pose3> first = {pose_at(0.03, 0.02, 1.04, 0.0), pose_at(2.03, 0.12, 1.04, 0.0)};
  const std::vector<Pose3> second = {pose_at(3.03, -0.22, 1.04, 0.0), pose_at(5.03, 0.12, 1.04, 0.0)};
  return {submap_of(scene, first, first[0], 1), submap_of(scene, second, second[0], 2), first[0].inverse() * second[0]};
}

SlideContrast contrast_along(const SubmapPair& pair, const Pose3& T_target_source, const Eigen::Vector3d& axis,
                             double reach_m = 1.0) {
  const NearestVoxelSearch source(pair.source.map, VoxelPosition::kCentroid, reach_m);
  const NearestVoxelSearch target(pair.target.map, VoxelPosition::kCentroid, reach_m);
  PlanePair both{source, target};
  Vector6 motion = Vector6::Zero();
  motion.head<3>() = axis;
  return slide_contrast(both, T_target_source, motion);
}

TEST(SlideContrast, NothingStandsAgainstAMoveAlongABareCorridor) {
  const SubmapPair pair = pair_in(testing::bare_corridor());
  EXPECT_FALSE(contrast_along(pair, pair.T_target_source, Eigen::Vector3d::UnitX()).fixed());
  EXPECT_GT(contrast_along(pair, pair.T_target_source, Eigen::Vector3d::UnitY()).contrast, 3.0);
  EXPECT_GT(contrast_along(pair, pair.T_target_source, Eigen::Vector3d::UnitZ()).contrast, 3.0);
}

// The sides of one pillar are a few per cent of what is seen; they fit at one place.
TEST(SlideContrast, APillarDoes) {
  Scene scene = testing::bare_corridor();
  scene.push_back({{7.0, 0.6, 0.0}, {7.6, 1.4, 3.0}});
  const SubmapPair pair = pair_in(scene);
  const SlideContrast at_truth = contrast_along(pair, pair.T_target_source, Eigen::Vector3d::UnitX());
  EXPECT_TRUE(at_truth.fixed());
  EXPECT_EQ(at_truth.beyond_voxels, 2.0);
  const Pose3 slid = pose_at(0.7, 0.0, 0.0, 0.0) * pair.T_target_source;
  EXPECT_LT(contrast_along(pair, slid, Eigen::Vector3d::UnitX()).contrast, 1.0) << "it fits better 0.7 m from there";
}

// Off their place its sides meet nothing, while the walls beside it still meet theirs: the overlap is not gone.
TEST(SlideContrast, ALowPillarDoesToo) {
  Scene scene = testing::bare_corridor();
  scene.push_back({{7.0, 0.6, 0.0}, {7.3, 0.9, 1.0}});
  const SubmapPair pair = pair_in(scene);
  EXPECT_GT(contrast_along(pair, pair.T_target_source, Eigen::Vector3d::UnitX()).contrast, 2.0);
}

TEST(SlideContrast, AHandfulOfPointsMayFitByChance) {
  Scene scene = testing::bare_corridor();
  scene.push_back({{7.0, 0.6, 0.0}, {7.3, 0.9, 0.6}});
  const SubmapPair pair = pair_in(scene);
  EXPECT_FALSE(contrast_along(pair, pair.T_target_source, Eigen::Vector3d::UnitX()).fixed());
}

// Half of one submap's scans stand 20 cm beside the others: its pillar fits over that length.
TEST(SlideContrast, ABentSubmapFitsLessSharply) {
  Scene scene = testing::bare_corridor();
  for (const double x : {-2.0, 7.0, 10.0}) scene.push_back({{x, 0.6, 0.0}, {x + 0.6, 1.4, 3.0}});
  SubmapPair pair = pair_in(scene);
  Scene beside = scene;
  for (testing::Box& box : beside) {
    if (box.high_m.x() - box.low_m.x() > 1.0) continue;
    box.low_m.x() += 0.2;
    box.high_m.x() += 0.2;
  }
  const std::vector<Pose3> poses = {pose_at(3.03, -0.22, 1.04, 0.0), pose_at(5.03, 0.12, 1.04, 0.0)};
  beside.insert(beside.end(), scene.begin(), scene.end());
  pair.source = submap_of(beside, poses, poses[0], 2);
  const SlideContrast blurred = contrast_along(pair, pair.T_target_source, Eigen::Vector3d::UnitX());
  EXPECT_TRUE(blurred.fixed()) << blurred.contrast;
  EXPECT_GT(blurred.beyond_voxels, 2.0);
  EXPECT_GT(blurred.blur_voxels(),
            contrast_along(pair_in(scene), pair.T_target_source, Eigen::Vector3d::UnitX()).blur_voxels());
}

TEST(SlideContrast, SwappingTheRolesChangesLittle) {
  const SubmapPair pair = testing::room_pair();
  const SubmapPair swapped{pair.source, pair.target, pair.T_target_source.inverse()};
  const double forward = contrast_along(pair, pair.T_target_source, Eigen::Vector3d::UnitZ()).contrast;
  // The vertical is the same in both frames.
  const double backward = contrast_along(swapped, swapped.T_target_source, Eigen::Vector3d::UnitZ()).contrast;
  EXPECT_NEAR(backward / forward, 1.0, 0.1);
}

// Submaps may have their origin anywhere: a turn about a place far from it is the same turn.
TEST(SlideContrast, DoesNotDependOnWhereTheOriginIs) {
  Scene scene = testing::bare_corridor();
  scene.push_back({{7.0, 0.6, 0.0}, {7.6, 1.4, 3.0}});
  std::vector<double> contrasts;
  for (const double away_m : {0.0, 300.0}) {
    const auto map_from = [&](double x_m, std::uint64_t seed) {
      const Pose3 moved = pose_at(away_m + x_m, 0.1, 1.04, 0.0);
      std::vector<Eigen::Vector3d> points = testing::scan(scene, pose_at(x_m, 0.1, 1.04, 0.0), 0.01, seed);
      for (Eigen::Vector3d& point : points) point = moved * point;
      MapBuilder builder({.resolution_m = 0.1});
      builder.insert_scan(points, moved.translation_m());
      return builder.finish();
    };
    const VoxelMap first = map_from(0.03, 1);
    const VoxelMap second = map_from(3.03, 2);
    const NearestVoxelSearch target(first, VoxelPosition::kCentroid, 1.0);
    const NearestVoxelSearch source(second, VoxelPosition::kCentroid, 1.0);
    PlanePair both{source, target};
    Vector6 motion;
    motion.tail<3>() = Eigen::Vector3d(0.0, 0.0, 0.25);
    motion.head<3>() = -motion.tail<3>().cross(Eigen::Vector3d(away_m + 4.0, 0.0, 1.5));
    contrasts.push_back(slide_contrast(both, {}, motion).contrast);
  }
  EXPECT_NEAR(contrasts[1] / contrasts[0], 1.0, 0.1) << contrasts[0];
}

TEST(SlideContrast, KeepsWithinAShortReach) {
  const SubmapPair pair = pair_in(testing::bare_corridor());
  EXPECT_TRUE(contrast_along(pair, pair.T_target_source, Eigen::Vector3d::UnitZ(), 0.2).fixed());
}

TEST(SlideContrast, BlurFallsWithTheContrast) {
  EXPECT_NEAR((SlideContrast{1.5, 2.0}).blur_voxels(), 0.28, 1e-12);
  EXPECT_LT((SlideContrast{4.0, 2.0}).blur_voxels(), 0.05);
  EXPECT_GT((SlideContrast{1.6, 5.0}).blur_voxels(), 0.5);
}

}  // namespace
}  // namespace kilter
