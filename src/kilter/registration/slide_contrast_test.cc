// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/slide_contrast.h"

#include <gtest/gtest.h>

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

double contrast_along(const SubmapPair& pair, const Pose3& T_target_source, const Eigen::Vector3d& axis) {
  const NearestVoxelSearch source(pair.source.map, VoxelPosition::kCentroid, 1.0);
  const NearestVoxelSearch target(pair.target.map, VoxelPosition::kCentroid, 1.0);
  PlanePair both{source, target};
  Vector6 motion = Vector6::Zero();
  motion.head<3>() = axis;
  return slide_contrast(both, T_target_source, motion);
}

TEST(SlideContrast, NothingStandsAgainstAMoveAlongABareCorridor) {
  const SubmapPair pair = pair_in(testing::bare_corridor());
  EXPECT_LT(contrast_along(pair, pair.T_target_source, Eigen::Vector3d::UnitX()), kLeastContrast);
  EXPECT_GT(contrast_along(pair, pair.T_target_source, Eigen::Vector3d::UnitY()), 3.0);
  EXPECT_GT(contrast_along(pair, pair.T_target_source, Eigen::Vector3d::UnitZ()), 3.0);
}

// The sides of one pillar are a few per cent of what is seen; they fit at one place.
TEST(SlideContrast, APillarDoes) {
  Scene scene = testing::bare_corridor();
  scene.push_back({{7.0, 0.6, 0.0}, {7.6, 1.4, 3.0}});
  const SubmapPair pair = pair_in(scene);
  EXPECT_GT(contrast_along(pair, pair.T_target_source, Eigen::Vector3d::UnitX()), kLeastContrast);
  const Pose3 slid = pose_at(0.4, 0.0, 0.0, 0.0) * pair.T_target_source;
  EXPECT_LT(contrast_along(pair, slid, Eigen::Vector3d::UnitX()), 1.0) << "it fits better 0.4 m from there";
}

TEST(SlideContrast, SwappingTheRolesChangesLittle) {
  const SubmapPair pair = testing::room_pair();
  const SubmapPair swapped{pair.source, pair.target, pair.T_target_source.inverse()};
  const double forward = contrast_along(pair, pair.T_target_source, Eigen::Vector3d::UnitZ());
  // The vertical is the same in both frames.
  const double backward = contrast_along(swapped, swapped.T_target_source, Eigen::Vector3d::UnitZ());
  EXPECT_NEAR(backward / forward, 1.0, 0.1);
}

TEST(BlurVoxels, FallsWithTheContrast) {
  EXPECT_GT(blur_voxels(kLeastContrast), 0.2);
  EXPECT_LT(blur_voxels(4.0), 0.05);
}

}  // namespace
}  // namespace kilter
