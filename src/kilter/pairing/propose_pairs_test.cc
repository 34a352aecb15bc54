// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/pairing/propose_pairs.h"

#include <gtest/gtest.h>

#include <numbers>

#include "kilter/occupancy/map_builder.h"
#include "kilter/pairing/coarse_overlap.h"

namespace kilter {
namespace {

// A 6 m x 6 m floor with a wall, enough voxels to pass every gate.
VoxelMap floor_map() {
  std::vector<Eigen::Vector3d> points;
  for (int x = 0; x < 60; ++x) {
    for (int y = 0; y < 60; ++y) points.emplace_back(0.1 * x + 0.03, 0.1 * y + 0.04, 0.05);
    for (int z = 0; z < 20; ++z) points.emplace_back(0.1 * x + 0.03, 0.02, 0.1 * z + 0.05);
  }
  MapBuilder builder({.resolution_m = 0.1});
  builder.insert_points(points);
  return builder.finish();
}

Submap submap_at(int id, int robot, int index, double x_m, double path_m) {
  Submap submap;
  submap.id = {id};
  submap.robot = robot;
  submap.index = index;
  submap.T_world_submap = Pose3::from_translation(x_m, 0.0, 0.0);
  submap.path_start_m = path_m;
  submap.path_end_m = path_m + 5.0;
  submap.map = floor_map();
  return submap;
}

std::vector<CandidatePair> propose(const std::vector<Submap>& submaps, const PairingOptions& options = {},
                                   const RunContext& run = {}) {
  std::vector<CoarseMap> maps;
  for (const Submap& submap : submaps) maps.emplace_back(submap.map, kMaxCoarseCells);
  return propose_pairs(std::vector<SubmapNode>(submaps.begin(), submaps.end()), maps, options, run);
}

std::vector<std::pair<int, int>> ids(const std::vector<CandidatePair>& proposal) {
  std::vector<std::pair<int, int>> out;
  for (const CandidatePair& pair : proposal) out.emplace_back(pair.id.source.value, pair.id.target.value);
  return out;
}

TEST(ProposePairs, NamesTheThreeKinds) {
  std::vector<Submap> submaps;
  for (int i = 0; i < 3; ++i) submaps.push_back(submap_at(i, 0, i, 0.5 * i, 10.0 * i));
  submaps.push_back(submap_at(3, 1, 0, 0.2, 0.0));
  const std::vector<CandidatePair> proposal = propose(submaps);
  const std::vector<std::pair<int, int>> expected = {{1, 0}, {2, 0}, {2, 1}, {3, 0}, {3, 1}, {3, 2}};
  EXPECT_EQ(ids(proposal), expected);
  EXPECT_EQ(proposal[0].kind, PairKind::kSequential);
  EXPECT_EQ(proposal[1].kind, PairKind::kLocal);
  EXPECT_EQ(proposal[3].kind, PairKind::kGlobal);
}

TEST(ProposePairs, LocalPairsBeginAtTheGap) {
  std::vector<Submap> submaps;
  for (int i = 0; i < 5; ++i) submaps.push_back(submap_at(i, 0, i, 0.1 * i, 10.0 * i));
  const std::vector<std::pair<int, int>> expected = {{1, 0}, {2, 1}, {3, 0}, {3, 2}, {4, 0}, {4, 1}, {4, 3}};
  EXPECT_EQ(ids(propose(submaps, {.local_min_gap = 3})), expected);
}

TEST(ProposePairs, FindsPairsThatDriftedApart) {
  std::vector<Submap> submaps = {submap_at(0, 0, 0, 0.0, 0.0), submap_at(1, 0, 1, 200.0, 300.0),
                                 submap_at(2, 0, 2, 9.0, 600.0)};
  const std::vector<CandidatePair> with_drift = propose(submaps);
  ASSERT_EQ(ids(with_drift), (std::vector<std::pair<int, int>>{{1, 0}, {2, 0}, {2, 1}}));
  EXPECT_LT(with_drift[1].predicted_shift_m.x(), -1.0);
  const std::vector<CandidatePair> without = propose(submaps, {.drift_per_metre = 0.0});
  EXPECT_EQ(ids(without), (std::vector<std::pair<int, int>>{{1, 0}, {2, 1}}));
}

TEST(ProposePairs, SaysWhichCandidatesPromiseTooLittle) {
  std::vector<Submap> submaps = {submap_at(0, 0, 0, 0.0, 0.0), submap_at(1, 1, 0, 6.5, 0.0),
                                 submap_at(2, 1, 1, 2.0, 0.0)};
  const std::vector<CandidatePair> proposal = propose(submaps, {.drift_per_metre = 0.0});
  ASSERT_EQ(ids(proposal), (std::vector<std::pair<int, int>>{{1, 0}, {2, 0}, {2, 1}}));
  EXPECT_FALSE(proposal[0].predicted_enough);
  EXPECT_TRUE(proposal[1].predicted_enough);
}

// A wall's box is a few centimetres thin: a doubled wall lies beside it and must still be a candidate.
TEST(CoarseOverlap, SeesAWallBesideAWall) {
  std::vector<Eigen::Vector3d> points;
  for (int y = 0; y < 80; ++y) {
    for (int z = 0; z < 30; ++z) points.emplace_back(3.02, 0.1 * y + 0.03, 0.1 * z + 0.04);
  }
  MapBuilder builder({.resolution_m = 0.1});
  builder.insert_points(points);
  const VoxelMap wall = builder.finish();
  const CoarseMap seen(wall, kMaxCoarseCells);
  const CoarseOverlap doubled =
      coarse_overlap(seen, seen, Pose3::from_translation(0.2, 0.0, 0.0), Eigen::Vector3d::Zero());
  EXPECT_GT(doubled.overlap, 0.9);
}

// A tall post, 0.4 m wide.
void add_post(double x_m, double y_m, std::vector<Eigen::Vector3d>& points) {
  for (int z = 0; z < 60; ++z) {
    for (int x = 0; x < 4; ++x) points.emplace_back(x_m + 0.1 * x + 0.03, y_m, 0.1 * z + 0.05);
  }
}

VoxelMap map_of(const std::vector<Eigen::Vector3d>& points) {
  MapBuilder builder({.resolution_m = 0.1});
  builder.insert_points(points);
  return builder.finish();
}

// Most of the source meets the kerb when moved one way, most of the target the source's post when moved the other way.
TEST(ProposePairs, TheShiftIsTheOneWhoseOverlapIsTold) {
  std::vector<Submap> submaps = {submap_at(0, 0, 0, 0.0, 0.0), submap_at(1, 1, 0, 0.0, 400.0)};
  std::vector<Eigen::Vector3d> kerb;
  for (int x = 0; x < 60; ++x) kerb.emplace_back(0.1 * x + 0.03, 0.02, 0.05);
  add_post(2.8, 6.02, kerb);
  submaps[0].map = map_of(kerb);
  std::vector<Eigen::Vector3d> floor;
  for (int x = 0; x < 60; ++x) {
    for (int y = 0; y < 60; ++y) floor.emplace_back(0.1 * x + 0.03, 0.1 * y + 0.04, 0.05);
  }
  add_post(2.8, 3.02, floor);
  const Pose3 quarter(Eigen::Quaterniond(Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitZ())),
                      Eigen::Vector3d::Zero());
  for (Eigen::Vector3d& point : floor) point = quarter.inverse() * point;
  submaps[1].map = map_of(floor);
  submaps[1].T_world_submap = quarter;

  const std::vector<CandidatePair> proposal = propose(submaps);
  ASSERT_EQ(proposal.size(), 1U);
  const Eigen::Vector3d shift_m = proposal[0].predicted_shift_m;
  const CoarseMap source(submaps[1].map, kMaxCoarseCells);
  const CoarseMap target(submaps[0].map, kMaxCoarseCells);
  const CoarseOverlap forward =
      best_coarse_overlap(source, target, quarter, proposal[0].drift_allowance_m, Eigen::Vector3d::UnitZ());
  ASSERT_LT(forward.overlap, proposal[0].predicted_overlap);
  ASSERT_LT(forward.shift_m.y(), -2.0);
  EXPECT_GT(shift_m.y(), 2.0) << shift_m.transpose();
  const Pose3 moved = Pose3::from_translation(shift_m.x(), shift_m.y(), shift_m.z()) * quarter;
  EXPECT_NEAR(coarse_overlap(target, source, moved.inverse(), Eigen::Vector3d::Zero()).overlap,
              proposal[0].predicted_overlap, 1e-9);
}

// Drift leads over the ground, however the sensor is mounted.
TEST(ProposePairs, ShiftsOverTheGroundWhateverTheSensorsAttitude) {
  std::vector<Eigen::Vector3d> walls_m;
  for (int along = 0; along < 60; ++along) {
    for (int z = 0; z < 20; ++z) {
      walls_m.emplace_back(0.1 * along + 0.03, 0.02, 0.1 * z + 0.05);
      walls_m.emplace_back(0.02, 0.1 * along + 0.04, 0.1 * z + 0.05);
    }
  }
  const double quarter = 0.5 * std::numbers::pi;
  for (const auto& [angle, axis] : {std::pair(0.0, 0), std::pair(quarter, 0), std::pair(-quarter, 1)}) {
    const Pose3 mounted(Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::Unit(axis))),
                        Eigen::Vector3d::Zero());
    std::vector<Submap> submaps = {submap_at(0, 0, 0, 0.0, 0.0), submap_at(1, 1, 0, 0.0, 400.0)};
    std::vector<Eigen::Vector3d> seen_m;
    for (const Eigen::Vector3d& point_m : walls_m) seen_m.push_back(mounted.inverse() * point_m);
    for (Submap& submap : submaps) submap.map = map_of(seen_m);
    submaps[0].T_world_submap = mounted;
    submaps[1].T_world_submap = Pose3::from_translation(3.2, 3.2, 0.0) * mounted;
    const std::vector<CandidatePair> proposal = propose(submaps);
    ASSERT_EQ(proposal.size(), 1U) << axis;
    EXPECT_GT(proposal[0].predicted_overlap, 0.9) << axis;
    const Eigen::Vector3d shift_m = mounted.rotation() * proposal[0].predicted_shift_m;
    EXPECT_NEAR(shift_m.z(), 0.0, 1e-9) << axis;
    EXPECT_LT(shift_m.x(), -1.5) << axis;
    EXPECT_LT(shift_m.y(), -1.5) << axis;
  }
}

TEST(ProposePairs, SequentialPairsAreListedEvenWithoutOverlapOrPoints) {
  std::vector<Submap> submaps = {submap_at(0, 0, 0, 0.0, 0.0), submap_at(1, 0, 1, 500.0, 500.0)};
  submaps[1].map = MapBuilder({.resolution_m = 0.1}).finish();
  EXPECT_EQ(ids(propose(submaps)), (std::vector<std::pair<int, int>>{{1, 0}}));
}

TEST(ProposePairs, ThreadsChangeNothing) {
  std::vector<Submap> submaps;
  for (int i = 0; i < 8; ++i) submaps.push_back(submap_at(i, i / 4, i % 4, 1.3 * i, 10.0 * i));
  const std::vector<CandidatePair> one = propose(submaps, {}, {.threads = 1});
  const std::vector<CandidatePair> four = propose(submaps, {}, {.threads = 4});
  ASSERT_EQ(ids(one), ids(four));
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].predicted_overlap, four[i].predicted_overlap);
  }
}

TEST(CoarseOverlap, FullForTheSameMapAndNoneFarAway) {
  const VoxelMap map = floor_map();
  const CoarseMap seen(map, kMaxCoarseCells);
  EXPECT_NEAR(coarse_overlap(seen, seen, {}, Eigen::Vector3d::Zero()).overlap, 1.0, 1e-12);
  EXPECT_NEAR(coarse_overlap(seen, seen, {}, Eigen::Vector3d::Zero()).matched, static_cast<double>(map.voxels().size()),
              1e-6);
  EXPECT_EQ(coarse_overlap(seen, seen, Pose3::from_translation(0.0, 0.0, 50.0), Eigen::Vector3d::Zero()).matched, 0.0);
}

}  // namespace
}  // namespace kilter
