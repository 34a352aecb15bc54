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

using enum Standing;

// Source i against target k of the other robot, ten metres of journey each.
Correction pair_asking(int i, int k, const Eigen::Vector3d& shift_m) {
  Correction correction = asking(i, shift_m);
  correction.id = {{10 + i}, {k}};
  correction.target_path_m = 10.0 * k;
  return correction;
}

// Of 1 against 1, with one that shares its source and one that shares its target.
std::vector<int> vouched(const Eigen::Vector3d& own_m, const Eigen::Vector3d& others_m,
                         const std::vector<Standing>& standings = {kDoubted, kMoves, kMoves}) {
  const std::vector<Correction> corrections = {pair_asking(1, 1, own_m), pair_asking(1, 2, others_m),
                                               pair_asking(2, 1, others_m)};
  return count_vouching({corrections, {}}, standings, 0.1);
}

TEST(CountVouching, CountsThoseThatAreBelievedAndAskForTheSame) {
  const Eigen::Vector3d move_m(3.0, 0.5, 0.0);
  EXPECT_EQ(vouched(move_m, move_m)[0], 2);
  EXPECT_EQ(vouched(move_m, {0.0, 4.0, 0.0})[0], 0);
  EXPECT_EQ(vouched(move_m, move_m, {kDoubted, kDoubted, kDoubted})[0], 0) << "storeys that all fit each other";
}

// What odometry may bend on the way is no move, though both may lie within it.
TEST(CountVouching, SmallMovesHaveToBeTheSameMove) {
  EXPECT_EQ(vouched({0.2, 0.0, 0.0}, {0.25, 0.05, 0.0})[0], 2);
  EXPECT_EQ(vouched({0.15, 0.0, 0.0}, {-0.15, 0.0, 0.0})[0], 0) << "nearer than the allowance, but another way";
  EXPECT_EQ(vouched({0.15, 0.0, 0.0}, {0.08, 0.0, 0.0})[0], 0) << "below the tolerance";
  EXPECT_EQ(vouched({0.08, 0.0, 0.0}, {0.15, 0.0, 0.0})[0], 0);
}

// One that stays within the allowance of a small move does not ask for it.
TEST(CountVouching, SmallMovesAreDeniedByThoseThatStay) {
  const Eigen::Vector3d move_m(0.2, 0.0, 0.0);
  const std::vector<Correction> corrections = {pair_asking(1, 1, move_m), pair_asking(1, 2, move_m),
                                               pair_asking(2, 1, move_m), pair_asking(0, 1, Eigen::Vector3d::Zero())};
  const std::vector<Standing> stays = {kDoubted, kMoves, kMoves, kStays};
  EXPECT_EQ(count_vouching({corrections, {}}, stays, 0.1)[0], 0);
}

TEST(CountVouching, ASlipBesideOneOfTheTwoIsNoReason) {
  const Eigen::Vector3d move_m(3.0, 0.5, 0.0);
  EXPECT_EQ(vouched(move_m, move_m, {kDoubted, kMoves, kDoubted})[0], 0);
  EXPECT_EQ(vouched(move_m, move_m, {kDoubted, kDoubted, kMoves})[0], 0);
}

TEST(CountVouching, NobodyVouchesForAMoveThatABelievedNeighbourDenies) {
  const Eigen::Vector3d move_m(3.0, 0.5, 0.0);
  const std::vector<Correction> corrections = {pair_asking(1, 1, move_m), pair_asking(1, 2, move_m),
                                               pair_asking(2, 1, move_m), pair_asking(0, 1, {0.01, 0.0, 0.0})};
  const CorrectionIndex index(corrections, {});
  const std::vector<Standing> stays = {kDoubted, kMoves, kMoves, kStays};
  const std::vector<Standing> doubted = {kDoubted, kMoves, kMoves, kDoubted};
  EXPECT_EQ(count_vouching(index, stays, 0.1)[0], 0);
  EXPECT_EQ(count_vouching(index, doubted, 0.1)[0], 2);
}

TEST(CountVouching, OfOneRobotOnlyThoseThatCloseOverTheSameWay) {
  const auto across = [](int source, int target) {
    Correction correction = pair_asking(source, target, {0.5, 0.0, 0.0});
    correction.id = {{source}, {target}};
    correction.source_robot = 0;
    return correction;
  };
  const std::vector<Correction> corrections = {across(2, 1), across(2, 0), across(3, 1), across(1, 0), across(3, 2)};
  const CorrectionIndex index(corrections, {});
  const std::vector<Standing> around = {kDoubted, kMoves, kMoves, kDoubted, kDoubted};
  const std::vector<Standing> beside = {kDoubted, kDoubted, kDoubted, kMoves, kMoves};
  EXPECT_EQ(count_vouching(index, around, 0.1)[0], 2);
  EXPECT_EQ(count_vouching(index, beside, 0.1)[0], 0) << "those are other slips";
}

// Of source 1 against target 2, which was not registered.
int movers(const std::vector<Correction>& around, const std::vector<Standing>& standings, double tolerance_m = 0.1) {
  Correction pair = pair_asking(1, 2, Eigen::Vector3d::Zero());
  pair.sigma_m = pair.sigma_rad = 0.0;
  return count_movers({around, {}}, standings, pair, tolerance_m);
}

TEST(CountMovers, NeedsSomeOfItsSourceAndOfItsTargetThatPutItToOnePlace) {
  const Eigen::Vector3d move_m(3.0, 0.0, 0.0);
  std::vector<Correction> around = {pair_asking(0, 1, move_m), pair_asking(1, 1, move_m), pair_asking(2, 2, move_m)};
  const std::vector<Standing> all_move(3, kMoves);
  EXPECT_EQ(movers(around, all_move), 3);
  EXPECT_EQ(movers(around, all_move, 2.9), 0) << "what odometry may bend on the way could explain it";
  EXPECT_EQ(movers(around, {kMoves, kMoves, kDoubted}), 0) << "none of its target";
  EXPECT_EQ(movers(around, {kMoves, kDoubted, kMoves}), 0) << "none of its source";
  EXPECT_EQ(movers({around[1], around[2]}, {kMoves, kMoves}), 0) << "none that shares neither";
  around[2] = pair_asking(2, 2, {0.0, 3.0, 0.0});
  EXPECT_EQ(movers(around, all_move), 0) << "they do not put it to the same place";
}

TEST(CountMovers, OneThatStaysDenies) {
  const Eigen::Vector3d move_m(3.0, 0.0, 0.0);
  std::vector<Correction> around = {pair_asking(0, 1, move_m), pair_asking(1, 1, move_m), pair_asking(2, 2, move_m),
                                    pair_asking(2, 3, Eigen::Vector3d::Zero())};
  const std::vector<Standing> standings = {kMoves, kMoves, kMoves, kStays};
  EXPECT_EQ(movers(around, standings), 0);
  around[3].sigma_m = 0.4;  // still far below what the others ask for
  EXPECT_EQ(movers(around, standings), 0);
  around[3].sigma_m = 2.0;
  EXPECT_EQ(movers(around, standings), 3) << "it could not tell";
}

// The smaller of the rigid motion here and of the shift where the neighbour overlaps counts.
TEST(CountMovers, ATurnElsewhereIsNoMove) {
  std::vector<Correction> around = {pair_asking(1, 0, Eigen::Vector3d::Zero()),
                                    pair_asking(1, 1, Eigen::Vector3d::Zero()),
                                    pair_asking(2, 2, Eigen::Vector3d::Zero())};
  for (Correction& one : around) {
    one.centre_world_m = {-50.0, 0.0, 0.0};
    Vector6 turn = Vector6::Zero();
    turn[5] = 0.05;
    const Pose3 about = Pose3::exp(turn);
    one.T_world_correction = {about.rotation(), one.centre_world_m - about.rotation() * one.centre_world_m};
  }
  EXPECT_EQ(movers(around, std::vector<Standing>(3, kMoves)), 0);
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
