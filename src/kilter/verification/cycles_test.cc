// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/verification/cycles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "kilter/base/rng.h"

namespace kilter {
namespace {

Vector6 drawn(Rng& rng, const Matrix6& covariance) {
  Vector6 white;
  for (int k = 0; k < 6; ++k) white[k] = rng.normal();
  return covariance.llt().matrixL() * white;
}

// Centimetres ahead, millimetres sideways, a tenth of a degree; leaning, so that frames matter.
Matrix6 lopsided() {
  Vector6 sigma;
  sigma << 0.03, 0.004, 0.01, 0.001, 0.002, 0.004;
  Matrix6 lean = Matrix6::Identity();
  lean(5, 1) = 0.2;
  lean(0, 4) = 0.5;
  return lean * sigma.cwiseAbs2().asDiagonal() * lean.transpose();
}

// Submaps along a bent path, each registered with the next `reach`; errors have `error_scale` times the covariance
// told.
std::vector<RelativePose> registered(int submaps, double error_scale, int reach = 4) {
  Rng rng(3, 1);
  Vector6 step;
  step << 10.0, 0.5, 0.1, 0.02, -0.01, 0.3;
  std::vector<Pose3> T_world(1);
  while (static_cast<int>(T_world.size()) < submaps) T_world.push_back(T_world.back() * Pose3::exp(step));
  std::vector<RelativePose> poses;
  for (int target = 0; target < submaps; ++target) {
    for (int source = target + 1; source < std::min(target + reach + 1, submaps); ++source) {
      const Pose3 T = T_world[static_cast<std::size_t>(target)].inverse() * T_world[static_cast<std::size_t>(source)];
      const Matrix6 covariance = lopsided();
      poses.push_back({{{source}, {target}}, T * Pose3::exp(drawn(rng, error_scale * covariance)), covariance});
    }
  }
  return poses;
}

TEST(Cycles, AnHonestCovarianceIsLeftAlone) {
  const CycleClosure closure = close_cycles(registered(120, 1.0));
  EXPECT_EQ(closure.closed, 700U);  // each with the next four: six cycles from each submap, fewer from the last three
  ASSERT_TRUE(closure.nees_median);
  EXPECT_NEAR(*closure.nees_median, 0.89, 0.15);
  EXPECT_LT(closure.covariance_scale, 1.15);
}

TEST(Cycles, SayByHowMuchCovariancesAreTooSmall) {
  EXPECT_NEAR(close_cycles(registered(120, 9.0)).covariance_scale, 9.0, 1.5);
  EXPECT_EQ(close_cycles(registered(120, 0.1)).covariance_scale, 1.0) << "too wide ones are not narrowed";
}

TEST(Cycles, AFewWrongRegistrationsDoNotWidenTheOthers) {
  std::vector<RelativePose> poses = registered(120, 1.0);
  for (std::size_t k = 0; k < poses.size(); k += 20) {
    poses[k].T_target_source = Pose3::from_translation(0.0, 1.0, 0.0) * poses[k].T_target_source;
  }
  EXPECT_LT(close_cycles(poses).covariance_scale, 1.6);
}

// A hall that 200 submaps see has 1.3 million cycles; of each submap's partners 64 are asked.
TEST(Cycles, OfManyThatSeeOnePlaceSomeAreAsked) {
  const CycleClosure closure = close_cycles(registered(200, 4.0, 200));
  EXPECT_LT(closure.closed, 650'000U);
  EXPECT_GT(closure.closed, 100'000U);
  EXPECT_NEAR(closure.covariance_scale, 4.0, 0.6);
}

// Who is source and who target is a matter of numbering.
TEST(Cycles, DoNotDependOnWhoIsTheSource) {
  std::vector<RelativePose> poses = registered(40, 4.0);
  const CycleClosure before = close_cycles(poses);
  for (std::size_t k = 0; k < poses.size(); k += 2) {
    RelativePose& pose = poses[k];
    const Matrix6 Ad = adjoint(pose.T_target_source);
    pose = {{pose.id.target, pose.id.source}, pose.T_target_source.inverse(), Ad * pose.covariance * Ad.transpose()};
  }
  const CycleClosure after = close_cycles(poses);
  EXPECT_EQ(after.closed, before.closed);
  EXPECT_NEAR(*after.nees_median, *before.nees_median, 1e-6);
}

TEST(Cycles, TooFewSayNothing) {
  EXPECT_EQ(close_cycles({}).closed, 0U);
  EXPECT_FALSE(close_cycles({}).nees_median);
  const CycleClosure one = close_cycles(registered(3, 100.0));
  EXPECT_EQ(one.closed, 1U);
  EXPECT_EQ(one.covariance_scale, 1.0);
  // A covariance of nothing cannot be judged.
  std::vector<RelativePose> sure = registered(40, 1.0);
  for (RelativePose& pose : sure) pose.covariance.setZero();
  EXPECT_EQ(close_cycles(sure).closed, 0U);
}

}  // namespace
}  // namespace kilter
