// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/registration.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <tuple>
#include <vector>

#include "kilter/occupancy/map_builder.h"
#include "kilter/occupancy/occupancy_cells.h"
#include "kilter/registration/point_to_plane.h"
#include "testing/scenes.h"

namespace kilter {
namespace {

using testing::pose_at;
using testing::room_pair;
using testing::submap_of;
using testing::SubmapPair;

RegistrationResult run(const SubmapPair& pair, const Pose3& start, RegistrationMethod method) {
  const VoxelPosition position =
      method == RegistrationMethod::kOicp ? VoxelPosition::kCentre : VoxelPosition::kCentroid;
  const NearestVoxelSearch source(pair.source.map, position, 1.0);
  const NearestVoxelSearch target(pair.target.map, position, 1.0);
  return align_submaps(source, target, start, {.method = method}, {});
}

TEST(AlignSubmaps, PointToPlaneFindsTheTruthFromDriftedStarts) {
  const SubmapPair pair = room_pair();
  for (const double shift_m : {0.0, 0.1, 0.3, 0.5}) {
    const Pose3 start = pose_at(shift_m, -0.5 * shift_m, 0.2 * shift_m, 0.1 * shift_m) * pair.T_target_source;
    const RegistrationResult result = run(pair, start, RegistrationMethod::kPointToPlane);
    ASSERT_TRUE(result.converged()) << to_string(result.stop) << " from " << shift_m;
    const Pose3 error = pair.T_target_source.inverse() * result.T_target_source;
    EXPECT_LT(error.translation_m().norm(), 0.02) << shift_m;
    EXPECT_LT(error.angle_rad(), 0.004) << shift_m;
    EXPECT_TRUE(result.unobservable.empty());
  }
}

// A large map and a corner of it: whether enough of them meets does not depend on which is called the source.
TEST(AlignSubmaps, TheGateDoesNotAskWhichIsTheSource) {
  const auto walls = [](double x_m, double y_m, double z_m) {
    std::vector<Eigen::Vector3d> points;
    const auto add = [&](const Eigen::Vector3d& along, const Eigen::Vector3d& up, const Eigen::Vector2d& size_m) {
      for (double a = 0.02; a < size_m.x(); a += 0.05) {
        for (double b = 0.02; b < size_m.y(); b += 0.05) points.emplace_back(a * along + b * up);
      }
    };
    add(Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), {x_m, y_m});
    add(Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ(), {x_m, z_m});
    add(Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ(), {y_m, z_m});
    MapBuilder builder({.resolution_m = 0.1});
    builder.insert_points(points);
    return builder.finish();
  };
  const VoxelMap hall = walls(24.0, 20.0, 8.0);
  const VoxelMap corner = walls(0.9, 0.9, 0.9);
  ASSERT_GT(hall.voxels().size(), 36000U);
  const NearestVoxelSearch large(hall, VoxelPosition::kCentroid, 1.0);
  const NearestVoxelSearch small(corner, VoxelPosition::kCentroid, 1.0);
  const RegistrationResult small_onto_large = align_submaps(small, large, {}, {}, {});
  const RegistrationResult large_onto_small = align_submaps(large, small, {}, {}, {});
  EXPECT_EQ(to_string(small_onto_large.stop), to_string(large_onto_small.stop));
  EXPECT_TRUE(large_onto_small.converged());
}

// A hall of 48 by 6 m with cupboards at uneven distances, seen 5 m far every 4 m; the map has the robot off to its left
// by as much as `left_m` says for each scan.
Submap hall_seen_along(const std::vector<double>& left_m, std::uint64_t seed) {
  testing::Scene hall = {{{-1.0, -0.2, -0.2}, {49.0, 6.2, 0.0}}, {{-1.0, -0.2, 3.0}, {49.0, 6.2, 3.2}},
                         {{-1.0, -0.2, 0.0}, {49.0, 0.0, 3.0}},  {{-1.0, 6.0, 0.0}, {49.0, 6.2, 3.0}},
                         {{-1.0, 0.0, 0.0}, {-0.8, 6.0, 3.0}},   {{48.8, 0.0, 0.0}, {49.0, 6.0, 3.0}}};
  for (int k = 0; k < 16; ++k) {
    const double at_m = 1.0 + 2.9 * k + 0.4 * ((k * 7) % 5);
    const double low_m = k % 2 == 0 ? 0.0 : 5.4;
    hall.push_back({{at_m, low_m, 0.0}, {at_m + 0.8, low_m + 0.6, 2.0}});
  }
  Submap submap;
  MapBuilder builder({.resolution_m = 0.1, .min_range_m = 0.3, .max_range_m = 5.0});
  for (std::size_t i = 0; i < left_m.size(); ++i) {
    const double x_m = 2.0 + 4.0 * static_cast<double>(i);
    const Pose3 believed = pose_at(x_m, 3.0 + left_m[i], 1.5, 0.0);
    std::vector<Eigen::Vector3d> points = testing::scan(hall, pose_at(x_m, 3.0, 1.5, 0.0), 0.01, 1000 * seed + i);
    for (Eigen::Vector3d& point : points) point = believed * point;
    builder.insert_scan(points, believed.translation_m());
  }
  submap.map = builder.finish();
  return submap;
}

// Two of twelve scans lie 15 cm off. Most surfaces meet where the others are; the least apart, as a mean square, is
// what lies a sixth of the way towards them.
TEST(AlignSubmaps, ABentSubmapIsPutWhereAllOfItIsLeastApart) {
  const Submap target = hall_seen_along(std::vector<double>(12, 0.0), 1);
  std::vector<double> left_m(12, 0.0);
  left_m[5] = left_m[6] = 0.15;
  const Submap source = hall_seen_along(left_m, 2);
  const RegistrationResult result =
      run({target, source, {}}, pose_at(0.05, 0.05, 0.0, 0.0), RegistrationMethod::kPointToPlane);
  ASSERT_TRUE(result.converged());
  EXPECT_EQ(result.bend.kind, BendKind::kSource);
  EXPECT_NEAR(result.bend.rms_m, 0.15 * std::sqrt(5.0 / 36.0), 0.012);
  const Eigen::Vector3d middle_m(24.0, 3.0, 1.5);
  EXPECT_NEAR((result.T_target_source_closest * middle_m - middle_m).y(), 0.0, 0.01);
  EXPECT_NEAR((result.T_target_source * middle_m - middle_m).y(), -0.15 / 6.0, 0.01);
}

// What the bend would move the pose by, about the registration's centre.
Vector6 step_of(const RegistrationResult& result) {
  Vector6 step = result.bend.common;
  step.head<3>() += step.tail<3>().cross(result.centre_target_m - result.bend.centre_m);
  return step;
}

// Rigid submaps seem bent by some millimetres. Their surfaces say better where they belong, and how much the two
// answers differ is part of what is not known.
TEST(AlignSubmaps, RigidSubmapsStayWhereTheirSurfacesMeet) {
  const std::vector<double> straight_m(12, 0.0);
  const RegistrationResult result = run({hall_seen_along(straight_m, 1), hall_seen_along(straight_m, 2), {}},
                                        pose_at(0.05, 0.05, 0.0, 0.0), RegistrationMethod::kPointToPlane);
  ASSERT_TRUE(result.converged());
  EXPECT_GT(result.bend.rms_m, 0.0);
  EXPECT_EQ(result.bend.noise_share, 1.0) << result.bend.rms_m;
  EXPECT_TRUE(result.T_target_source.isometry().isApprox(result.T_target_source_closest.isometry(), 1e-12));
  const Vector6 step = step_of(result);
  const Matrix6 without = result.covariance_measured - step * step.transpose();
  EXPECT_GT(step.dot(without.ldlt().solve(step)), 1.5) << "surfaces alone would exclude the other answer";
  EXPECT_LE(step.dot(result.covariance_measured.ldlt().solve(step)), 1.001);
}

TEST(AlignSubmaps, ABendLittleBeyondNoiseMovesThePosePartOfTheWay) {
  std::vector<double> left_m(12, 0.0);
  left_m[5] = left_m[6] = 0.045;
  const RegistrationResult result =
      run({hall_seen_along(std::vector<double>(12, 0.0), 1), hall_seen_along(left_m, 2), {}},
          pose_at(0.05, 0.05, 0.0, 0.0), RegistrationMethod::kPointToPlane);
  ASSERT_TRUE(result.converged());
  const double noise_share = std::pow(0.01 / result.bend.rms_m, 2);
  EXPECT_NEAR(result.bend.noise_share, noise_share, 1e-9);
  ASSERT_GT(noise_share, 0.2);
  ASSERT_LT(noise_share, 0.8);
  const Vector6 step = step_of(result);
  const auto moved_m = [&](const Pose3& T) {
    return (T * result.T_target_source_closest.inverse()) * result.centre_target_m;
  };
  const Eigen::Vector3d centre_m = result.centre_target_m;
  EXPECT_LT((moved_m(result.T_target_source) - centre_m - (1.0 - noise_share) * step.head<3>()).norm(), 1e-6);
  EXPECT_GT(step.head<3>().norm(), 1e-3);
}

RegistrationResult run_widely(const SubmapPair& pair, const Pose3& start) {
  const NearestVoxelSearch source(pair.source.map, VoxelPosition::kCentroid, 1.0);
  const NearestVoxelSearch target(pair.target.map, VoxelPosition::kCentroid, 1.0);
  RegistrationPrior prior;
  prior.up_target = pair.target.T_world_submap.rotation().conjugate() * Eigen::Vector3d::UnitZ();
  return align_widely(source, target, start, {}, prior);
}

TEST(AlignWidely, FindsTheTruthFromBeyondTheBasin) {
  const SubmapPair pair = room_pair();
  for (const auto& [x, y, yaw] : {std::tuple(1.5, -1.0, 0.1), std::tuple(-2.5, 2.0, -0.2), std::tuple(4.0, 1.0, 0.3)}) {
    const Pose3 start = pose_at(x, y, 0.1, yaw) * pair.T_target_source;
    const RegistrationResult result = run_widely(pair, start);
    ASSERT_TRUE(result.converged()) << to_string(result.stop) << " from " << x;
    EXPECT_TRUE(result.searched);
    const Pose3 error = pair.T_target_source.inverse() * result.T_target_source;
    EXPECT_LT(error.translation_m().norm(), 0.02) << x;
    EXPECT_LT(error.angle_rad(), 0.004) << x;
    ASSERT_TRUE(result.ambiguity.has_value());
    EXPECT_LT(*result.ambiguity, 0.6) << x;
    EXPECT_GT(result.support_end, 2 * result.support_start) << x;
  }
}

TEST(AlignWidely, StaysWhereTheMapIsRight) {
  const SubmapPair pair = room_pair();
  const RegistrationResult result = run_widely(pair, pair.T_target_source);
  ASSERT_TRUE(result.converged());
  EXPECT_LT((pair.T_target_source.inverse() * result.T_target_source).translation_m().norm(), 0.02);
}

// Rows of shelves, 4 m apart, seen from two neighbouring aisles. One aisle laid over the other overlaps in all that was
// seen, right poses only in the row between them; but pallets stand in the one where the other was seen to be free.
TEST(AlignWidely, DoesNotLeaveTheMapForAnAisleThatMerelyOverlapsMore) {
  testing::Scene hall = {{{-6.0, -6.0, -0.2}, {26.0, 18.0, 0.0}}};
  for (const double y : {2.0, 6.0, 10.0}) {
    for (int bay = 0; bay < 8; ++bay) {
      const double x = 2.5 * bay + (bay % 3 == 0 ? 0.4 : 0.0);
      hall.push_back({{x, y - 0.4, 0.0}, {x + 1.9, y + 0.4, bay % 2 == 0 ? 2.4 : 1.7}});
    }
  }
  hall.push_back({{7.0, 3.1, 0.0}, {8.2, 3.7, 0.9}});
  hall.push_back({{12.5, 8.5, 0.0}, {13.7, 9.1, 0.9}});
  std::vector<Pose3> first;
  std::vector<Pose3> second;
  for (int i = 0; i < 6; ++i) {
    first.push_back(pose_at(2.0 + 3.0 * i, 4.02, 1.04, 0.01));
    second.push_back(pose_at(2.3 + 3.0 * i, 7.97, 1.03, -0.01));
  }
  const SubmapPair pair{submap_of(hall, first, first[0], 1), submap_of(hall, second, second[0], 2),
                        first[0].inverse() * second[0]};
  const RegistrationResult result = run_widely(pair, pose_at(0.3, -0.2, 0.05, 0.02) * pair.T_target_source);
  ASSERT_TRUE(result.converged()) << to_string(result.stop);
  EXPECT_LT((pair.T_target_source.inverse() * result.T_target_source).translation_m().norm(), 0.03);
  EXPECT_FALSE(result.ambiguous()) << "what conflicts is no rival";
}

TEST(AlignWidely, FindsNothingWhereNothingStands) {
  const SubmapPair pair = room_pair();
  const RegistrationResult result = run_widely(pair, pose_at(60.0, 0.0, 0.0, 0.0) * pair.T_target_source);
  EXPECT_FALSE(result.converged());
}

// Floor and ceiling, most of the room, fit at every horizontal shift: only a few walls say where it belongs.
TEST(AlignSubmaps, HorizontalShiftsAreNotHiddenByTheFloor) {
  const SubmapPair pair = room_pair();
  for (const auto& [x, y] : {std::pair(0.25, 0.0), std::pair(0.0, 0.25), std::pair(0.5, 0.0), std::pair(-0.4, 0.3)}) {
    const RegistrationResult result =
        run(pair, pose_at(x, y, 0.0, 0.0) * pair.T_target_source, RegistrationMethod::kPointToPlane);
    ASSERT_TRUE(result.converged()) << to_string(result.stop);
    EXPECT_LT((pair.T_target_source.inverse() * result.T_target_source).translation_m().norm(), 0.02) << x << " " << y;
  }
}

// Walls fit at every height, a floor at every shift along it: what the move gained shows in what faces it.
TEST(AlignSubmaps, SupportCountsWhatFacesTheWayMoved) {
  const SubmapPair pair = room_pair();
  for (const auto& [x, y, z] : {std::tuple(0.0, 0.0, 0.1), std::tuple(0.1, 0.0, 0.0), std::tuple(0.06, -0.06, 0.05)}) {
    const RegistrationResult result =
        run(pair, pose_at(x, y, z, 0.0) * pair.T_target_source, RegistrationMethod::kPointToPlane);
    ASSERT_TRUE(result.converged()) << to_string(result.stop);
    EXPECT_GT(result.support_end, 3 * result.support_start) << x << " " << y << " " << z;
  }
}

TEST(AlignSubmaps, CovarianceCoversTheErrorButIsNotVast) {
  const SubmapPair pair = room_pair();
  const RegistrationResult result = run(pair, pair.T_target_source, RegistrationMethod::kPointToPlane);
  const Vector6 error = (result.T_target_source.inverse() * pair.T_target_source).log();
  const double nees = error.dot(result.covariance.ldlt().solve(error)) / 6.0;
  EXPECT_LT(nees, 6.0);
  EXPECT_LT(result.covariance.diagonal().head<3>().cwiseSqrt().maxCoeff(), 0.05);
}

// The same maps as trees keep them, with the centres of cells for points.
SubmapPair as_cells(SubmapPair pair, double resolution_m) {
  for (Submap* submap : {&pair.source, &pair.target}) {
    auto map = map_from_cells(*cells_from_map(submap->map, -0.4F), {.resolution_m = resolution_m});
    submap->map = *std::move(map);
  }
  return pair;
}

TEST(AlignSubmaps, KnowsWhatTheCellsHideThatPointsAreTheCentresOf) {
  const SubmapPair pair = room_pair();
  const RegistrationResult of_hits = run(pair, pair.T_target_source, RegistrationMethod::kPointToPlane);
  EXPECT_TRUE(of_hits.covariance_cells.isZero());
  const RegistrationResult of_cells = run(as_cells(pair, 0.1), pair.T_target_source, RegistrationMethod::kPointToPlane);
  ASSERT_TRUE(of_cells.converged()) << to_string(of_cells.stop);
  const Vector6 error = (of_cells.T_target_source.inverse() * pair.T_target_source).log();
  EXPECT_LT(error.dot(of_cells.covariance.ldlt().solve(error)) / 6.0, 3.0);
  // Floor and ceiling alone fix the height: at best the mean of two.
  const double alone_m = 0.1 / std::sqrt(6.0);
  EXPECT_GT(std::sqrt(of_cells.covariance_cells(2, 2)), 0.3 * alone_m);
  EXPECT_LT(std::sqrt(of_cells.covariance_cells(2, 2)), 1.01 * alone_m);
  EXPECT_GE(of_cells.covariance(2, 2), of_hits.covariance(2, 2));
}

TEST(AlignSubmaps, PlacesOfLargeVoxelsAreLarger) {
  for (const auto& [resolution_m, place_m] : {std::pair(0.1, 0.3), std::pair(0.25, 0.5)}) {
    MapBuilder builder({.resolution_m = resolution_m});
    builder.insert_points(testing::scan(testing::furnished_room(), pose_at(6.03, 4.02, 1.04, 0.0), 0.0, 1));
    const VoxelMap map = builder.finish();
    const NearestVoxelSearch search(map, VoxelPosition::kCentroid, 1.0);
    const RegistrationResult result = align_submaps(search, search, {}, {}, {});
    ASSERT_TRUE(result.converged()) << to_string(result.stop);
    EXPECT_EQ(result.place_m, place_m);
  }
}

TEST(AlignSubmaps, OicpComesNearFromCloseStarts) {
  const SubmapPair pair = room_pair();
  const Pose3 start = pose_at(0.2, -0.1, 0.0, 0.02) * pair.T_target_source;
  const RegistrationResult result = run(pair, start, RegistrationMethod::kOicp);
  ASSERT_TRUE(result.converged()) << to_string(result.stop);
  EXPECT_LT((pair.T_target_source.inverse() * result.T_target_source).translation_m().norm(), 0.12);
}

// Point to point creeps: a search that narrows on its way leaves it among matches of the wrong walls.
TEST(AlignSubmaps, OicpKeepsItsSearchWideWhileItMoves) {
  const SubmapPair pair = room_pair();
  for (const auto& [x, y] : {std::pair(0.6, 0.0), std::pair(0.0, 0.6), std::pair(0.5, -0.5)}) {
    const RegistrationResult result =
        run(pair, pose_at(x, y, 0.0, 0.0) * pair.T_target_source, RegistrationMethod::kOicp);
    ASSERT_TRUE(result.converged()) << to_string(result.stop);
    EXPECT_LT((pair.T_target_source.inverse() * result.T_target_source).translation_m().norm(), 0.12) << x << " " << y;
  }
}

// Five metres apart in a corridor without ends.
SubmapPair corridor_pair() {
  const auto scene = testing::bare_corridor();
  const std::vector<Pose3> first = {pose_at(0.03, 0.02, 1.04, 0.0), pose_at(2.03, 0.12, 1.04, 0.0)};
  const std::vector<Pose3> second = {pose_at(5.03, -0.22, 1.04, 0.0), pose_at(7.03, 0.12, 1.04, 0.0)};
  return {submap_of(scene, first, first[0], 1), submap_of(scene, second, second[0], 2), first[0].inverse() * second[0]};
}

TEST(AlignSubmaps, CorridorAxisIsReportedAndHeldAtTheStart) {
  const SubmapPair pair = corridor_pair();
  const Pose3 start = pose_at(0.25, 0.15, 0.0, 0.01) * pair.T_target_source;
  const RegistrationResult result = run(pair, start, RegistrationMethod::kPointToPlane);
  ASSERT_TRUE(result.converged()) << to_string(result.stop);
  ASSERT_EQ(result.unobservable.size(), 1U);
  EXPECT_GT(std::abs(result.unobservable[0][0]), 0.95);
  EXPECT_NEAR((pair.T_target_source.inverse() * result.T_target_source).translation_m().y(), 0.0, 0.02);
  EXPECT_GT(std::sqrt(result.covariance(0, 0)), 0.5);  // the prior's, not a claim
}

TEST(AlignSubmaps, OicpClaimsNothingAlongACorridor) {
  const SubmapPair pair = corridor_pair();
  const RegistrationResult result =
      run(pair, pose_at(0.6, 0.0, 0.0, 0.0) * pair.T_target_source, RegistrationMethod::kOicp);
  ASSERT_TRUE(result.converged()) << to_string(result.stop);
  ASSERT_EQ(result.unobservable.size(), 1U);
  EXPECT_GT(std::abs(result.unobservable[0][0]), 0.95) << result.unobservable[0].transpose();
  EXPECT_GT(std::sqrt(result.covariance(0, 0)), 0.9) << "the prior's";
  const SubmapPair room = room_pair();
  EXPECT_TRUE(run(room, room.T_target_source, RegistrationMethod::kOicp).unobservable.empty());
}

// Along a corridor every pose fits; the wide search would take the one that overlaps most.
TEST(AlignWidely, DoesNotClaimAMoveAlongACorridor) {
  const SubmapPair pair = corridor_pair();
  for (const double along_m : {0.0, 2.0}) {
    const Pose3 start = pose_at(along_m, 0.5, 0.0, 0.05) * pair.T_target_source;
    const RegistrationResult result = run_widely(pair, start);
    ASSERT_TRUE(result.converged()) << to_string(result.stop);
    ASSERT_EQ(result.unobservable.size(), 1U);
    EXPECT_FALSE(result.ambiguous()) << "what it could slide to is no other place: " << *result.ambiguity;
    const Eigen::Vector3d& here_m = result.centre_target_m;
    const Eigen::Vector3d shift_m = here_m - start * (result.T_target_source.inverse() * here_m);
    EXPECT_NEAR(shift_m.dot(result.unobservable[0].head<3>()), 0.0, 0.03) << along_m;
    EXPECT_NEAR((result.T_target_source * (pair.T_target_source.inverse() * here_m)).y(), here_m.y(), 0.02) << along_m;
  }
}

TEST(AlignSubmaps, FailuresSayWhy) {
  const SubmapPair pair = room_pair();
  const RegistrationResult far =
      run(pair, pose_at(60.0, 0.0, 0.0, 0.0) * pair.T_target_source, RegistrationMethod::kPointToPlane);
  EXPECT_EQ(far.stop, StopReason::kTooFewMatches);
  EXPECT_EQ(run(pair, pose_at(60.0, 0.0, 0.0, 0.0), RegistrationMethod::kOicp).stop, StopReason::kTooFewMatches);
}

TEST(AlignSubmaps, NothingTurnsFartherFromTheMapsPoseThanIsAllowed) {
  const SubmapPair pair = room_pair();
  const NearestVoxelSearch source(pair.source.map, VoxelPosition::kCentroid, 1.0);
  const NearestVoxelSearch target(pair.target.map, VoxelPosition::kCentroid, 1.0);
  const Pose3 start = pose_at(0.0, 0.0, 0.0, 0.12) * pair.T_target_source;
  RegistrationOptions options;
  RegistrationPrior prior;
  prior.translation_m = 0.5;
  const auto stops = [&] {
    return std::array{align_widely(source, target, start, options, prior).stop,
                      align_near(source, target, start, pair.T_target_source, options, prior).stop};
  };
  options.max_rotation_rad = 0.13;
  for (const StopReason stop : stops()) EXPECT_EQ(stop, StopReason::kConverged);
  options.max_rotation_rad = 0.1;  // the right pose lies beyond
  for (const StopReason stop : stops()) EXPECT_EQ(stop, StopReason::kOutOfRange);
}

TEST(AlignSubmaps, SwappingTheRolesInvertsTheResult) {
  const SubmapPair pair = room_pair();
  const SubmapPair swapped{pair.source, pair.target, pair.T_target_source.inverse()};
  const Pose3 start = pose_at(0.15, -0.1, 0.05, 0.02) * pair.T_target_source;
  const RegistrationResult forward = run(pair, start, RegistrationMethod::kPointToPlane);
  const RegistrationResult backward = run(swapped, start.inverse(), RegistrationMethod::kPointToPlane);
  const Pose3 round_trip = forward.T_target_source * backward.T_target_source;
  EXPECT_LT(round_trip.translation_m().norm(), 0.003);
  EXPECT_LT(round_trip.angle_rad(), 0.0005);
}

TEST(AlignSubmaps, GivesTheSameBitsEachTime) {
  const SubmapPair pair = room_pair();
  const Pose3 start = pose_at(0.1, 0.0, 0.0, 0.0) * pair.T_target_source;
  const RegistrationResult once = run(pair, start, RegistrationMethod::kPointToPlane);
  const RegistrationResult again = run(pair, start, RegistrationMethod::kPointToPlane);
  EXPECT_EQ(once.T_target_source.translation_m(), again.T_target_source.translation_m());
  EXPECT_EQ(once.covariance, again.covariance);
}

}  // namespace
}  // namespace kilter
