// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <vector>

#include "kilter/occupancy/map_builder.h"
#include "kilter/registration/descent.h"
#include "kilter/registration/point_to_plane.h"
#include "kilter/registration/registration.h"
#include "testing/scenes.h"

namespace kilter {
namespace {

using testing::pose_at;
using testing::room_pair;
using testing::SubmapPair;

StopReason stop_of(const SubmapPair& pair, const Pose3& start, const RegistrationOptions& options) {
  const VoxelPosition position =
      options.method == RegistrationMethod::kOicp ? VoxelPosition::kCentre : VoxelPosition::kCentroid;
  const NearestVoxelSearch source(pair.source.map, position, 1.0);
  const NearestVoxelSearch target(pair.target.map, position, 1.0);
  return align_submaps(source, target, start, options, {}).stop;
}

TEST(StopReasons, BothMethodsSayThatIterationsRanOut) {
  const SubmapPair pair = room_pair();
  const Pose3 start = pose_at(0.3, -0.1, 0.0, 0.02) * pair.T_target_source;
  for (const auto method : {RegistrationMethod::kPointToPlane, RegistrationMethod::kOicp}) {
    EXPECT_EQ(stop_of(pair, start, {.method = method}), StopReason::kConverged);
    EXPECT_EQ(stop_of(pair, start, {.method = method, .max_iterations = 3}), StopReason::kMaxIterations);
  }
}

TEST(StopReasons, BothMethodsSayThatTheyTurnedTooFar) {
  const SubmapPair pair = room_pair();
  const Pose3 start = pose_at(0.0, 0.0, 0.0, 0.12) * pair.T_target_source;
  for (const auto method : {RegistrationMethod::kPointToPlane, RegistrationMethod::kOicp}) {
    EXPECT_EQ(stop_of(pair, start, {.method = method, .max_rotation_rad = 0.3}), StopReason::kConverged);
    EXPECT_EQ(stop_of(pair, start, {.method = method, .max_rotation_rad = 0.06}), StopReason::kOutOfRange);
  }
}

// Walls of 4 m by 4 m across the x axis.
VoxelMap walls_at(const std::vector<double>& x_m, double width_of_last_m) {
  std::vector<Eigen::Vector3d> points;
  for (const double at_m : x_m) {
    for (double y = 0.05; y < (at_m == x_m.back() ? width_of_last_m : 4.0); y += 0.1) {
      for (double z = 0.05; z < 4.0; z += 0.1) points.emplace_back(at_m, y, z);
    }
  }
  MapBuilder builder({.resolution_m = 0.1});
  builder.insert_points(points);
  return builder.finish();
}

// The large wall goes to its like, and takes the small one out of the reach of its own.
TEST(StopReasons, OicpSaysThatOverlapWasLost) {
  const VoxelMap source_map = walls_at({0.05, -2.95}, 2.0);
  const VoxelMap target_map = walls_at({0.65, -3.75}, 2.0);
  const NearestVoxelSearch source(source_map, VoxelPosition::kCentre, 1.0);
  const NearestVoxelSearch target(target_map, VoxelPosition::kCentre, 1.0);
  const RegistrationResult result = align_submaps(source, target, {}, {.method = RegistrationMethod::kOicp}, {});
  EXPECT_EQ(result.stop, StopReason::kOverlapLost);
  EXPECT_TRUE(result.T_target_source.translation_m().isZero(0.0)) << "nothing was aligned";
}

// A scene leaves a direction open, or some of them; all six are where the caller holds the rest.
TEST(StopReasons, ADescentThatIsHeldInAllDirectionsSaysThatNothingFixesIt) {
  const SubmapPair rooms = room_pair();
  const NearestVoxelSearch source(rooms.source.map, VoxelPosition::kCentroid, 1.0);
  const NearestVoxelSearch target(rooms.target.map, VoxelPosition::kCentroid, 1.0);
  PlanePair pair{source, target};
  HeldMotions held;
  for (int k = 0; k < 5; ++k) held.emplace_back(Vector6::Unit(k));
  EXPECT_EQ(descend(pair, rooms.T_target_source, {}, 1.0, held).stop, StopReason::kConverged);
  held.emplace_back(Vector6::Unit(5));
  const Descent descent = descend(pair, rooms.T_target_source, {}, 1.0, held);
  EXPECT_EQ(descent.stop, StopReason::kDegenerate);
  EXPECT_FALSE(descent.ended());
}

}  // namespace
}  // namespace kilter
