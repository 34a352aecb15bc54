// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/plane_matches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "kilter/base/rng.h"
#include "kilter/matching/same_side.h"
#include "testing/scenes.h"

namespace kilter {
namespace {

constexpr double kReach_m = 1.0;

struct Rooms {
  explicit Rooms(VectorPath path = vector_paths().back())
      : source(pair.source.map, VoxelPosition::kCentroid, kReach_m, path),
        target(pair.target.map, VoxelPosition::kCentroid, kReach_m, path) {}

  testing::SubmapPair pair = testing::room_pair();
  NearestVoxelSearch source;
  NearestVoxelSearch target;
  Pose3 T_target_source = Pose3::from_translation(0.05, -0.03, 0.02) * pair.T_target_source;
};

std::vector<PlaneResidual> matches_of(const Rooms& rooms, std::span<const std::uint32_t> voxels, double search_m) {
  RepeatedSearch in_target(rooms.target, rooms.source.map().voxels().size());
  std::vector<PlaneResidual> matches;
  match_voxels(rooms.source.map(), voxels, in_target, rooms.T_target_source, search_m, matches);
  return matches;
}

std::vector<std::uint32_t> all_of(const VoxelMap& map) {
  std::vector<std::uint32_t> numbers(map.voxels().size());
  std::iota(numbers.begin(), numbers.end(), 0U);
  return numbers;
}

void expect_same(const PlaneResidual& a, const PlaneResidual& b) {
  EXPECT_EQ(a.point_m, b.point_m);
  EXPECT_EQ(a.direction, b.direction);
  EXPECT_EQ(a.residual_m, b.residual_m);
  EXPECT_EQ(a.weight, b.weight);
  EXPECT_EQ(a.source_at, b.source_at);
  EXPECT_EQ(a.target_at, b.target_at);
}

// A shift that is the same everywhere finds what the moved pose finds, and reports where things are without it.
TEST(MatchPlanes, LookWhereAShiftPutsThem) {
  const Rooms rooms;
  PlanePair pair{rooms.source, rooms.target};
  const Eigen::Vector3d shift_m(-0.05, 0.03, -0.02);
  std::size_t asked = 0;
  const auto shifted =
      match_planes(pair, rooms.T_target_source, kReach_m, kAllPoints, [&](const Eigen::Vector3d&, auto, auto) {
        ++asked;
        return shift_m;
      });
  const auto moved =
      match_planes(pair, Pose3(Eigen::Quaterniond::Identity(), shift_m) * rooms.T_target_source, kReach_m, kAllPoints);
  EXPECT_GE(asked, shifted.size());
  ASSERT_GT(shifted.size(), 1000U);
  EXPECT_LE(shifted.size(), moved.size());
  EXPECT_GE(shifted.size(), moved.size() * 95 / 100) << "only what meets nothing without the shift is left out";
  // What a voxel of the source asks lies a shift away; what one of the target asks lies where it was.
  std::size_t next = 0;
  for (const PlaneResidual& r : shifted) {
    const auto same = [&](const PlaneResidual& other) {
      const Eigen::Vector3d apart_m = other.point_m - r.point_m;
      return std::min((apart_m - shift_m).norm(), apart_m.norm()) < 1e-6 &&
             (other.direction - r.direction).norm() < 1e-6;
    };
    while (next < moved.size() && !same(moved[next])) ++next;
    ASSERT_LT(next, moved.size());
    EXPECT_NEAR(moved[next].residual_m, r.residual_m + r.direction.dot(shift_m), 1e-6);
  }
}

// One voxel after the other, by the definitions.
TEST(MatchVoxels, AreWhatTheFieldTheLimitAndTheNormalsAllow) {
  const Rooms rooms;
  constexpr double kSearch_m = 0.3;
  const VoxelMap& onto = rooms.target.map();
  const SurfaceVoxels& points = rooms.source.map().voxels();
  const std::vector<std::uint32_t> voxels = all_of(rooms.source.map());
  const std::vector<PlaneResidual> matches = matches_of(rooms, voxels, kSearch_m);
  std::size_t next = 0;
  std::size_t turned_away = 0;
  for (const std::uint32_t i : voxels) {
    const Eigen::Isometry3d T = rooms.T_target_source.isometry();
    const Eigen::Vector3d at_m = T * points.centroids_m[i].cast<double>();
    const std::uint32_t plane = rooms.target.field()->near(at_m);
    if (plane == kNoVoxel) continue;
    const Eigen::Vector3d centroid_m = onto.voxels().centroids_m[plane].cast<double>();
    const Eigen::Vector3d normal = onto.voxels().normals[plane].cast<double>();
    if ((centroid_m - at_m).norm() > kSearch_m || normal.isZero()) continue;
    if (!normals_agree(T.linear() * points.normals[i].cast<double>(), normal, true)) {
      ++turned_away;
      continue;
    }
    ASSERT_LT(next, matches.size());
    const PlaneResidual& match = matches[next++];
    EXPECT_NEAR((match.point_m - at_m).norm(), 0.0, 1e-12);
    EXPECT_EQ(match.direction, normal);
    EXPECT_NEAR(match.residual_m, normal.dot(at_m - centroid_m), 1e-12);
    EXPECT_EQ(match.weight, static_cast<double>(onto.voxels().planarity[plane]));
    EXPECT_EQ(match.source_at, points.seen_at[i]);
    EXPECT_EQ(match.target_at, onto.voxels().seen_at[plane]);
  }
  EXPECT_EQ(next, matches.size());
  EXPECT_GT(next, voxels.size() / 2);
  EXPECT_GT(turned_away, 10U);
}

TEST(MatchVoxels, AreTheSameOnEveryPath) {
  const Rooms usual(VectorPath::kBaseline);
  const std::vector<PlaneResidual> expected = matches_of(usual, all_of(usual.source.map()), kReach_m);
  for (const VectorPath path : vector_paths()) {
    const Rooms rooms(path);
    const std::vector<PlaneResidual> matches = matches_of(rooms, all_of(rooms.source.map()), kReach_m);
    ASSERT_EQ(matches.size(), expected.size());
    for (std::size_t i = 0; i < matches.size(); ++i) expect_same(matches[i], expected[i]);
  }
}

// Batches of voxels must not know of each other, nor the last one of what stood in its columns before.
TEST(MatchVoxels, DoNotDependOnWhichOthersAreAsked) {
  const Rooms rooms;
  const std::vector<std::uint32_t> voxels = all_of(rooms.source.map());
  const std::vector<PlaneResidual> together = matches_of(rooms, voxels, kReach_m);
  std::vector<PlaneResidual> apart;
  for (std::size_t first = 0, size = 1; first < voxels.size(); first += size, size = size % 131 + 1) {
    const auto some = std::span(voxels).subspan(first, std::min(size, voxels.size() - first));
    const std::vector<PlaneResidual> matches = matches_of(rooms, some, kReach_m);
    apart.insert(apart.end(), matches.begin(), matches.end());
  }
  ASSERT_EQ(apart.size(), together.size());
  for (std::size_t i = 0; i < apart.size(); ++i) expect_same(apart[i], together[i]);
}

TEST(MatchPlanes, TakeTheMemoryOfWhatWasFoundBeforeAndNothingElse) {
  const Rooms rooms;
  PlanePair pair{rooms.source, rooms.target};
  const std::vector<PlaneResidual> expected = match_planes(pair, rooms.T_target_source, kReach_m, kAllPoints);
  std::vector<PlaneResidual> again(7);
  match_planes(pair, rooms.T_target_source, kReach_m, kAllPoints, again);
  ASSERT_EQ(again.size(), expected.size());
  for (std::size_t i = 0; i < again.size(); ++i) expect_same(again[i], expected[i]);
}

TEST(ApplyKernel, ItsScaleIsThatOfTheMedianResidualButNeverBelowTheLeast) {
  Rng rng(5, 0);
  for (const std::size_t count : {1, 2, 3, 10, 4999}) {
    for (const double outlier_m : {0.0, 1.0, 1e6}) {
      std::vector<PlaneResidual> residuals(count);
      std::vector<double> sizes_m;
      for (PlaneResidual& r : residuals) {
        r.residual_m = rng.uniform(0.0, 1.0) < 0.3 ? -outlier_m : rng.uniform(-0.1, 0.1);
        r.weight = rng.uniform(0.0, 1.0);
        sizes_m.push_back(std::abs(r.residual_m));
      }
      std::sort(sizes_m.begin(), sizes_m.end());
      const double least_m = 0.02;
      const double scale_m = std::max(2.0 * 1.4826 * sizes_m[count / 2], least_m);
      std::vector<PlaneResidual> weighted = residuals;
      apply_kernel(weighted, least_m);
      for (std::size_t i = 0; i < count; ++i) {
        ASSERT_EQ(weighted[i].weight, residuals[i].weight * geman_mcclure(residuals[i].residual_m, scale_m));
      }
    }
  }
}

}  // namespace
}  // namespace kilter
