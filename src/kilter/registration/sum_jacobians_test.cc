// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/sum_jacobians.h"

#include <gtest/gtest.h>

#include <vector>

#include "kilter/base/rng.h"

namespace kilter {
namespace {

TEST(SumJacobians, EveryPathGivesTheSameBits) {
  Rng rng(11, 0);
  std::vector<PlaneResidual> residuals;
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d point_m(rng.uniform(-40, 40), rng.uniform(-40, 40), rng.uniform(-2, 4));
    const Eigen::Vector3d direction = Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal()).normalized();
    residuals.push_back({point_m, direction, 0.1 * rng.normal(), rng.uniform(0.0, 1.0), 3, 250});
  }
  const Eigen::Vector3d centre_m(1.25, -3.5, 0.7);
  Matrix6 information = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
  for (const PlaneResidual& r : residuals) {
    const Vector6 j = plain_jacobian(r, centre_m);
    information += r.weight * j * j.transpose();
    gradient += r.weight * r.residual_m * j;
  }
  const JacobianSums baseline = sum_jacobians_with(VectorPath::kBaseline)(residuals, centre_m);
  EXPECT_TRUE(baseline.information.isApprox(information, 1e-12));
  EXPECT_TRUE(baseline.gradient.isApprox(gradient, 1e-12));
  for (const VectorPath path : vector_paths()) {
    const JacobianSums sums = sum_jacobians_with(path)(residuals, centre_m);
    EXPECT_TRUE((sums.information.array() == baseline.information.array()).all());
    EXPECT_TRUE((sums.gradient.array() == baseline.gradient.array()).all());
    const JacobianSums nothing = sum_jacobians_with(path)({}, centre_m);
    EXPECT_TRUE(nothing.information.isZero(0.0) && nothing.gradient.isZero(0.0));
  }
}

TEST(ChangeOfResidual, IsTheJacobianTimesTheMotion) {
  Rng rng(8, 1);
  const auto any = [&] { return Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal()); };
  for (int k = 0; k < 200; ++k) {
    const PlaneResidual r{10.0 * any(), any().normalized(), rng.normal(), 1.0};
    const Eigen::Vector3d centre_m = 3.0 * any();
    Vector6 motion;
    motion << any(), any();
    EXPECT_NEAR(change_of_residual(r, centre_m, motion), plain_jacobian(r, centre_m).dot(motion), 1e-12);
  }
}

}  // namespace
}  // namespace kilter
