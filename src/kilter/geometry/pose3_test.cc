// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/geometry/pose3.h"

#include <gtest/gtest.h>

#include <numbers>
#include <unsupported/Eigen/MatrixFunctions>

#include "kilter/base/rng.h"

namespace kilter {
namespace {

Vector6 random_twist(Rng& rng, double scale) {
  Vector6 xi;
  for (int i = 0; i < 6; ++i) xi[i] = scale * rng.normal();
  return xi;
}

TEST(Pose3, ExpAgreesWithTheMatrixExponential) {
  Rng rng(1, 0);
  for (const double scale : {1e-9, 1e-4, 0.1, 1.0}) {
    const Vector6 xi = random_twist(rng, scale);
    Eigen::Matrix4d generator = Eigen::Matrix4d::Zero();
    generator.topLeftCorner<3, 3>() = skew(xi.tail<3>());
    generator.topRightCorner<3, 1>() = xi.head<3>();
    const Eigen::Matrix4d expected = generator.exp();
    EXPECT_LT((Pose3::exp(xi).isometry().matrix() - expected).norm(), 1e-12);
  }
}

TEST(Pose3, LogUndoesExp) {
  Rng rng(2, 0);
  for (const double scale : {1e-9, 1e-3, 0.5, 1.2}) {
    const Vector6 xi = random_twist(rng, scale);
    if (xi.tail<3>().norm() > std::numbers::pi) continue;
    EXPECT_LT((Pose3::exp(xi).log() - xi).norm(), 1e-11 * std::max(1.0, xi.norm())) << scale;
  }
}

TEST(Pose3, InverseAndProductFollowTheGroupLaws) {
  Rng rng(3, 0);
  const Pose3 a = Pose3::exp(random_twist(rng, 1.0));
  const Pose3 b = Pose3::exp(random_twist(rng, 1.0));
  const Eigen::Vector3d point(1.0, -2.0, 3.0);
  EXPECT_LT((((a * b) * point) - (a * (b * point))).norm(), 1e-14);
  EXPECT_LT((a * a.inverse()).log().norm(), 1e-14);
}

TEST(Pose3, AdjointMovesATwistAcross) {
  Rng rng(4, 0);
  const Pose3 T = Pose3::exp(random_twist(rng, 1.0));
  const Vector6 xi = random_twist(rng, 0.3);
  const Pose3 left = T * Pose3::exp(xi);
  const Pose3 right = Pose3::exp(adjoint(T) * xi) * T;
  EXPECT_LT((left.inverse() * right).log().norm(), 1e-13);
}

TEST(Pose3, LogIsFiniteAtHalfTurns) {
  const Pose3 half_turn(Eigen::Quaterniond(0.0, 0.0, 0.0, 1.0), Eigen::Vector3d(1.0, 0.0, 0.0));
  EXPECT_TRUE(half_turn.log().allFinite());
  EXPECT_NEAR(half_turn.angle_rad(), std::numbers::pi, 1e-12);
}

}  // namespace
}  // namespace kilter
