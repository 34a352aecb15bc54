// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/verification/agreement.h"

#include <gtest/gtest.h>

#include <cmath>

#include "kilter/base/rng.h"

namespace kilter {
namespace {

// Source i of robot 1 against target i of robot 0, ten metres of journey apart, asking for a shift.
Correction asking(int i, const Eigen::Vector3d& shift_m) {
  Correction correction;
  correction.id = {{10 + i}, {i}};
  correction.source_robot = 1;
  correction.source_path_m = 10.0 * i;
  correction.target_path_m = 10.0 * i;
  correction.T_world_correction = Pose3::from_translation(shift_m.x(), shift_m.y(), shift_m.z());
  correction.centre_world_m = {10.0 * i, 0.0, 0.0};
  correction.sigma_m = 0.02;
  correction.sigma_rad = 0.002;
  return correction;
}

std::vector<Agreement> compared(const std::vector<Correction>& corrections, const AgreementOptions& options = {}) {
  return compare_corrections({corrections, options});
}

// Whatever their order, near() finds what asking all of them would find.
TEST(CorrectionIndex, FindsThoseNearAndNoOthers) {
  std::vector<Correction> corrections;
  Rng rng(7, 1);
  for (int i = 0; i < 300; ++i) {
    Correction& correction = corrections.emplace_back(asking(i, {0.0, 0.0, 0.0}));
    correction.source_robot = static_cast<int>(rng.uniform() * 3.0);
    correction.target_robot = static_cast<int>(rng.uniform() * 2.0);
    correction.source_path_m = std::floor(rng.uniform() * 200.0);
    correction.target_path_m = std::floor(rng.uniform() * 200.0);
  }
  const CorrectionIndex index(corrections, {});
  for (std::size_t i = 0; i < corrections.size(); ++i) {
    std::vector<std::size_t> expected;
    for (std::size_t k = 0; k < corrections.size(); ++k) {
      const Correction& a = corrections[i];
      const Correction& b = corrections[k];
      const double way_m = std::abs(a.source_path_m - b.source_path_m) + std::abs(a.target_path_m - b.target_path_m);
      if (k != i && a.source_robot == b.source_robot && a.target_robot == b.target_robot && way_m <= 40.0) {
        expected.push_back(k);
      }
    }
    EXPECT_EQ(index.near(corrections[i]), expected) << i;
  }
}

TEST(CompareCorrections, TheOddOneOutIsContradictedAndTheOthersAreNot) {
  std::vector<Correction> corrections;
  for (int i = 0; i < 5; ++i) corrections.push_back(asking(i, {3.0, 0.5, 0.0}));
  corrections[2] = asking(2, {-2.0, 4.0, 0.0});
  const std::vector<Agreement> agreements = compared(corrections);
  EXPECT_TRUE(agreements[2].contradicted());
  EXPECT_EQ(agreements[2].agreeing, 0);
  for (const std::size_t i : {0U, 1U, 3U, 4U}) {
    EXPECT_FALSE(agreements[i].contradicted()) << i;
    EXPECT_GE(agreements[i].agreeing, 1) << i;
  }
}

TEST(CompareCorrections, DriftOnTheWayIsAllowedFor) {
  // 20 m of journey each way may bend by 0.4 m; what they ask for is far more.
  const std::vector<Correction> corrections = {asking(0, {2.0, 0.0, 0.0}), asking(2, {2.4, 0.0, 0.0})};
  EXPECT_EQ(compared(corrections)[0].agreeing, 1);
  EXPECT_EQ(compared(corrections, {.drift_per_metre = 0.001})[0].contradicting, 1);
}

TEST(CompareCorrections, OtherRobotsAndFarPiecesSayNothing) {
  std::vector<Correction> corrections = {asking(0, {2.0, 0.0, 0.0}), asking(1, {0.0, 0.0, 0.0})};
  corrections[1].source_robot = 2;
  EXPECT_EQ(compared(corrections)[0].contradicting, 0);
  corrections[1] = asking(9, {0.0, 0.0, 0.0});
  EXPECT_EQ(compared(corrections)[0].contradicting, 0);
}

// Odometry slipped between submaps 2 and 3 of one robot: the pairs before and after it rightly ask for nothing.
TEST(CompareCorrections, PairsBesideASlipDoNotContradictTheOneAcrossIt) {
  const auto sequential = [](int i, double shift_m) {
    Correction correction = asking(i, {shift_m, 0.0, 0.0});
    correction.id = {{i}, {i - 1}};
    correction.source_robot = 0;
    correction.target_path_m = 10.0 * (i - 1);
    return correction;
  };
  std::vector<Correction> corrections = {sequential(1, 0.0), sequential(2, 0.0), sequential(3, 0.5),
                                         sequential(4, 0.0)};
  EXPECT_EQ(compared(corrections)[2].contradicting, 0);
  // One that reaches across the slip as well does speak.
  corrections.push_back(sequential(4, -0.5));
  corrections.back().id = {{4}, {2}};
  corrections.back().target_path_m = 20.0;
  EXPECT_EQ(compared(corrections)[2].contradicting, 1);
}

// A correction whose free direction could hide the difference does not contradict.
TEST(CompareCorrections, UncertainCorrectionsSayNothing) {
  std::vector<Correction> corrections = {asking(0, {0.6, 0.0, 0.0}), asking(1, {0.0, 0.0, 0.0})};
  corrections[1].sigma_m = 1.0;
  const Agreement agreement = compared(corrections)[0];
  EXPECT_EQ(agreement.agreeing + agreement.contradicting, 0);
}

TEST(CompareCorrections, AmbiguousNeighboursAreNotEnoughToContradict) {
  std::vector<Correction> corrections = {asking(0, {3.0, 0.0, 0.0}), asking(1, {-3.0, 0.0, 0.0})};
  corrections[1].weight = 0.1;
  EXPECT_FALSE(compared(corrections)[0].contradicted());
}

std::vector<int> vouched(const std::vector<Correction>& corrections, const std::vector<Standing>& standings) {
  return count_vouching({corrections, {}}, standings);
}

TEST(CountVouching, CountsThoseThatAreBelievedAndAskForTheSame) {
  std::vector<Correction> corrections;
  for (int i = 0; i < 4; ++i) corrections.push_back(asking(i, {3.0, 0.5, 0.0}));
  using enum Standing;
  EXPECT_EQ(vouched(corrections, {kDoubted, kMoves, kMoves, kMoves}), (std::vector{2, 2, 2, 2}))
      << "3 lies beyond the neighbourhood of 0, and 0 vouches for nobody";
  corrections[2] = asking(2, {0.0, 4.0, 0.0});
  EXPECT_EQ(vouched(corrections, {kDoubted, kMoves, kMoves, kMoves})[0], 1) << "beyond a slip others ask for others";
}

TEST(CountVouching, NobodyVouchesForAMoveThatABelievedNeighbourDenies) {
  using enum Standing;
  std::vector<Correction> corrections;
  for (int i = 0; i < 3; ++i) corrections.push_back(asking(i, {3.0, 0.5, 0.0}));
  corrections.push_back(asking(1, {0.01, 0.0, 0.0}));
  corrections.back().id = {{11}, {2}};
  EXPECT_EQ(vouched(corrections, {kDoubted, kMoves, kMoves, kStays})[0], 0);
  EXPECT_EQ(vouched(corrections, {kDoubted, kMoves, kMoves, kDoubted})[0], 2) << "if it is believed itself";
}

TEST(CountVouching, OfOneRobotOnlyThoseThatCloseOverTheSameWay) {
  const auto across = [](int source, int target) {
    Correction correction = asking(source, {0.5, 0.0, 0.0});
    correction.id = {{source}, {target}};
    correction.source_robot = 0;
    correction.target_path_m = 10.0 * target;
    return correction;
  };
  using enum Standing;
  EXPECT_EQ(vouched({across(2, 1), across(3, 2)}, {kDoubted, kMoves})[0], 0) << "that is another slip";
  EXPECT_EQ(vouched({across(2, 1), across(3, 1)}, {kDoubted, kMoves})[0], 1);
}

// Source i against target k, which was not registered.
Correction place_of(int i, int k) {
  Correction pair = asking(i, Eigen::Vector3d::Zero());
  pair.id = {{10 + i}, {k}};
  pair.target_path_m = 10.0 * k;
  return pair;
}

TEST(CountMovers, NeedsSomeOfItsSourceAndOfItsTargetThatPutItToOnePlace) {
  using enum Standing;
  const auto pair = [](int i, int k, const Eigen::Vector3d& shift_m) {
    Correction correction = place_of(i, k);
    correction.T_world_correction = Pose3::from_translation(shift_m.x(), shift_m.y(), shift_m.z());
    return correction;
  };
  const Eigen::Vector3d shift_m(3.0, 0.0, 0.0);
  std::vector<Correction> around = {pair(1, 0, shift_m), pair(1, 1, shift_m), pair(2, 2, shift_m)};
  const std::vector<Standing> moves(3, kMoves);
  const auto movers = [&](const std::vector<Standing>& standings, double tolerance_m = 0.1) {
    return count_movers({around, {}}, standings, place_of(1, 2), tolerance_m);
  };
  EXPECT_EQ(movers(moves), 3);
  EXPECT_EQ(movers(moves, 2.9), 0) << "what odometry may bend on the way could explain it";
  EXPECT_EQ(movers({kMoves, kMoves, kDoubted}), 0) << "none of its target: odometry may have slipped beside it";
  EXPECT_EQ(movers({kDoubted, kDoubted, kMoves}), 0) << "none of its source";
  EXPECT_EQ(movers({kMoves, kStays, kMoves}), 0);
  around[2] = pair(2, 2, {0.0, 3.0, 0.0});
  EXPECT_EQ(movers(moves), 0) << "they do not put it to the same place";
}

TEST(SuggestCorrection, TakesWhatTheNeighboursAgreeOn) {
  std::vector<Correction> corrections;
  for (int i = 0; i < 4; ++i) corrections.push_back(asking(i, {3.0, 0.5, 0.0}));
  corrections.push_back(asking(4, {-5.0, 0.0, 0.0}));
  const std::vector<Agreement> agreements = compared(corrections);
  const auto suggested = suggest_correction({corrections, {}}, agreements, corrections[4]);
  ASSERT_TRUE(suggested.has_value());
  EXPECT_NEAR(corrections[*suggested].T_world_correction.translation_m().x(), 3.0, 1e-12);
  EXPECT_FALSE(suggest_correction({{}, {}}, {}, corrections[4]).has_value());
}

}  // namespace
}  // namespace kilter
