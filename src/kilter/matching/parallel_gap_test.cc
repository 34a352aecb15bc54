// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/parallel_gap.h"

#include <gtest/gtest.h>

#include <utility>

#include "testing/scenes.h"

namespace kilter {
namespace {

using testing::furnished_room;
using testing::pose_at;
using testing::room_pair;
using testing::submap_of;
using testing::SubmapPair;

// The source where the map puts it if it is displaced by `shift_m`, along the target's axes.
std::optional<ParallelGap> gap_with(const SubmapPair& pair, const Eigen::Vector3d& shift_m) {
  const Pose3 shift = Pose3::from_translation(shift_m.x(), shift_m.y(), shift_m.z());
  return measure_parallel_gap(pair.source.map, pair.target.map, shift * pair.T_target_source);
}

// Unit vector along the room's x axis, in the target's axes.
Eigen::Vector3d room_x(const SubmapPair& pair) {
  return pair.target.T_world_submap.rotation().conjugate() * Eigen::Vector3d::UnitX();
}

TEST(MeasureParallelGap, IsNoneWhereTheMapIsRight) {
  const SubmapPair pair = room_pair();
  const auto gap = gap_with(pair, Eigen::Vector3d::Zero());
  ASSERT_TRUE(gap);
  EXPECT_LT(gap->gap_m, 0.01);
  EXPECT_GT(gap->p_value, 0.01);
}

TEST(MeasureParallelGap, IsRightWithinACentimetre) {
  const SubmapPair pair = room_pair();
  for (const double shift_m : {0.05, 0.1, 0.2, -0.3}) {
    const auto gap = gap_with(pair, shift_m * room_x(pair));
    ASSERT_TRUE(gap) << shift_m;
    EXPECT_NEAR(gap->gap_m, std::abs(shift_m), 0.01) << shift_m;
    EXPECT_LT(gap->p_value, 0.01) << shift_m;
    EXPECT_GT(std::abs(gap->normal.dot(room_x(pair))), 0.99) << shift_m;
  }
}

TEST(MeasureParallelGap, SeesAFloorThatIsThereTwice) {
  const SubmapPair pair = room_pair();
  const auto gap = gap_with(pair, {0.0, 0.0, 0.12});
  ASSERT_TRUE(gap);
  EXPECT_NEAR(gap->gap_m, 0.12, 0.01);
  EXPECT_GT(std::abs(gap->normal.z()), 0.99);
}

TEST(MeasureParallelGap, IsTheSameFromEitherSide) {
  const SubmapPair pair = room_pair();
  const Pose3 T = Pose3::from_translation(0.1, 0.05, 0.0) * pair.T_target_source;
  const auto forward = measure_parallel_gap(pair.source.map, pair.target.map, T);
  const auto backward = measure_parallel_gap(pair.target.map, pair.source.map, T.inverse());
  ASSERT_TRUE(forward && backward);
  EXPECT_NEAR(forward->gap_m, backward->gap_m, 0.01);
}

// The two sides of a thin wall face away from each other: nobody doubled them.
TEST(MeasureParallelGap, DoesNotTakeTheTwoSidesOfAWallForTwoWalls) {
  testing::Scene rooms = {{{-6.0, -4.0, -0.2}, {6.0, 4.0, 0.0}},  {{-6.0, -4.0, 3.0}, {6.0, 4.0, 3.2}},
                          {{-0.08, -4.0, 0.0}, {0.08, 4.0, 3.0}}, {{-6.2, -4.0, 0.0}, {-6.0, 4.0, 3.0}},
                          {{6.0, -4.0, 0.0}, {6.2, 4.0, 3.0}},    {{-6.0, -4.2, 0.0}, {6.0, -4.0, 3.0}},
                          {{-6.0, 4.0, 0.0}, {6.0, 4.2, 3.0}}};
  const Pose3 west = pose_at(-3.0, 0.3, 1.0, 0.2);
  const Pose3 east = pose_at(3.0, -0.4, 1.1, 0.5);
  const VoxelMap source = submap_of(rooms, {east}, east, 2).map;
  const VoxelMap target = submap_of(rooms, {west}, west, 1).map;
  const Pose3 T = west.inverse() * east;
  EXPECT_FALSE(measure_parallel_gap(source, target, T)) << "they have nothing else in common";
  SurfaceVoxels voxels = source.voxels();
  for (std::size_t i = 0; i < voxels.size(); ++i) voxels.normals[i] = -voxels.normals[i];
  const VoxelMap turned(source.resolution_m(), true, {source.blocks().begin(), source.blocks().end()},
                        std::move(voxels));
  const auto gap = measure_parallel_gap(turned, target, T);
  ASSERT_TRUE(gap) << "if they faced the same way";
  EXPECT_NEAR(gap->gap_m, 0.16, 0.01);
}

TEST(MeasureParallelGap, MeasuresPointsAloneToo) {
  const SubmapPair pair = room_pair();
  const VoxelMap& map = pair.source.map;
  SurfaceVoxels voxels = map.voxels();
  for (std::size_t i = 0; i < voxels.size(); i += 2) voxels.normals[i] = -voxels.normals[i];
  const VoxelMap points(map.resolution_m(), false, {map.blocks().begin(), map.blocks().end()}, std::move(voxels));
  const Eigen::Vector3d shift_m = 0.1 * room_x(pair);
  const Pose3 T = Pose3::from_translation(shift_m.x(), shift_m.y(), shift_m.z()) * pair.T_target_source;
  const auto gap = measure_parallel_gap(points, pair.target.map, T);
  ASSERT_TRUE(gap);
  EXPECT_NEAR(gap->gap_m, 0.1, 0.01);
}

TEST(MeasureParallelGap, IsAbsentWithoutACommonSurface) {
  const SubmapPair pair = room_pair();
  EXPECT_FALSE(measure_parallel_gap(VoxelMap(), pair.target.map, pair.T_target_source));
  EXPECT_FALSE(gap_with(pair, {100.0, 0.0, 0.0}));
}

}  // namespace
}  // namespace kilter
