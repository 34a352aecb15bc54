// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/uncertainty.h"

#include <Eigen/Cholesky>

#include <gtest/gtest.h>

namespace kilter {
namespace {

// Of a pair whose places lie round the target's origin, registered where the map has it: the covariance of xi is that
// of (v, w) there.
RegistrationResult registration_bent(double bend_m) {
  RegistrationResult registration;
  registration.stop = StopReason::kConverged;
  registration.places_arm_m = {0.1, -0.2, 0.0};
  registration.scatter_m2 = Eigen::Vector3d(30.0, 8.0, 1.0).asDiagonal();
  registration.covariance_measured = 1e-6 * Matrix6::Identity();
  registration.covariance_centre = registration.covariance_measured;
  registration.covariance_centre(0, 0) += 0.01;  // what the prior holds
  registration.bend.rms_m = bend_m;
  return registration;
}

TEST(ConstraintCovariance, IsTheRegistrationsWhereOneRigidMotionMendsThePair) {
  const RegistrationResult registration = registration_bent(0.08);
  EXPECT_TRUE(constraint_covariance(registration, true, 1.0).isApprox(registration.covariance_centre, 1e-12));
  const Matrix6 added = constraint_covariance(registration, true, 4.0) - registration.covariance_centre;
  EXPECT_TRUE(added.isApprox(3.0 * registration.covariance_measured, 1e-9)) << "the prior is not scaled";
}

TEST(ConstraintCovariance, ABendMovesPlacesByItsSizeAndAllSixDirectionsAlike) {
  for (const double bend_m : {0.12, 0.5}) {
    const RegistrationResult registration = registration_bent(bend_m);
    const Matrix6 added = constraint_covariance(registration, false, 1.0) - registration.covariance_centre;
    const Matrix6 M = displacement_form(registration.places_arm_m, registration.scatter_m2);
    EXPECT_NEAR((M * added).trace(), bend_m * bend_m, 0.02 * bend_m * bend_m);
    for (int axis = 0; axis < 6; ++axis) {
      EXPECT_NEAR((M * added)(axis, axis), bend_m * bend_m / 6.0, 0.02 * bend_m * bend_m) << axis;
    }
  }
}

TEST(ConstraintCovariance, PlacesOnALineLeaveTheTurnAroundItOpenAndNothingInfinite) {
  RegistrationResult registration = registration_bent(0.2);
  registration.places_arm_m.setZero();
  registration.scatter_m2 = Eigen::Vector3d(30.0, 0.0, 0.0).asDiagonal();
  const Matrix6 covariance = constraint_covariance(registration, false, 1.0);
  ASSERT_TRUE(covariance.allFinite());
  EXPECT_EQ(covariance.llt().info(), Eigen::Success);
  EXPECT_GT(covariance(3, 3), 100.0 * covariance(5, 5));
}

}  // namespace
}  // namespace kilter
