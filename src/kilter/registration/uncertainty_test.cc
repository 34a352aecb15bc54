// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/uncertainty.h"

#include <Eigen/Cholesky>

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

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

// Places of coarse voxels are larger, and so is the radius that turns about their line are seen at.
TEST(ConstraintCovariance, PlacesOnALineAreAsWideAsTheyAre) {
  RegistrationResult registration = registration_bent(0.2);
  registration.places_arm_m.setZero();
  registration.scatter_m2 = Eigen::Vector3d(30.0, 0.0, 0.0).asDiagonal();
  const auto turn_rad2 = [&] { return constraint_covariance(registration, false, 1.0)(3, 3) - 1e-6; };
  EXPECT_NEAR(turn_rad2(), 0.04 / 6.0 / (0.09 / 6.0), 1e-9);
  registration.place_m = 1.2;
  EXPECT_NEAR(turn_rad2(), 0.04 / 6.0 / (1.44 / 6.0), 1e-9);
}

// In a silo nothing fixes the turn about its axis. It is named where the places are, not where the pose is fixed from.
TEST(DescribeUncertainty, NamesTwistsAboutTheMiddleOfThePlaces) {
  const Eigen::Vector3d axis_m(10.0, 4.0, 0.0);
  std::vector<PlaneResidual> silo;
  for (int i = 0; i < 3600; ++i) {
    const double angle = 0.01745 * (i % 360);
    const Eigen::Vector3d inwards(-std::cos(angle), -std::sin(angle), 0.0);
    const Eigen::Vector3d at_m = axis_m - 3.0 * inwards + Eigen::Vector3d(0.0, 0.0, 0.3 * (i / 360));
    silo.push_back({at_m, i % 5 == 0 ? Eigen::Vector3d::UnitZ().eval() : inwards, 0.0, at_m.x() < 10.0 ? 1.0 : 0.2});
  }
  const NormalEquations equations = build_normal_equations(silo);
  RegistrationResult result;
  describe_uncertainty(moments_of(places_of(silo, kPlace_m)), equations, split_observable(equations, silo), {}, result);
  ASSERT_EQ(result.unobservable.size(), 1U);
  EXPECT_GT(result.places_arm_m.norm(), 0.5);
  const Vector6& twist = result.unobservable[0];
  const Eigen::Vector3d turn = twist.tail<3>();
  const Eigen::Vector3d arm_m = equations.centre_m + result.places_arm_m - axis_m;
  EXPECT_LT((twist.head<3>() - turn.cross(arm_m)).norm(), 0.01);
  EXPECT_GT(turn.norm(), 0.5);
}

}  // namespace
}  // namespace kilter
