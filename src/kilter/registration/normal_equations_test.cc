// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/normal_equations.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <array>
#include <map>

#include "kilter/base/rng.h"

namespace kilter {
namespace {

// Points on the faces of a box, displaced by a known small motion; `axes` says which faces exist.
std::vector<PlaneResidual> box_residuals(const Pose3& motion, std::array<bool, 3> axes, double noise_m,
                                         std::uint64_t seed) {
  Rng rng(seed, 0);
  std::vector<PlaneResidual> residuals;
  for (int i = 0; i < 3000; ++i) {
    const int axis = i % 3;
    if (!axes[static_cast<std::size_t>(axis)]) continue;
    Eigen::Vector3d point(rng.uniform(-4, 4), rng.uniform(-4, 4), rng.uniform(-4, 4));
    point[axis] = i % 2 == 0 ? 4.0 : -4.0;
    const Eigen::Vector3d moved = motion * point;
    residuals.push_back({moved, Eigen::Vector3d::Unit(axis), (moved - point)[axis] + noise_m * rng.normal(), 1.0});
  }
  return residuals;
}

TEST(NormalEquations, OneStepUndoesASmallMotion) {
  const Vector6 twist = (Vector6() << 0.01, -0.02, 0.015, 0.001, 0.002, -0.0015).finished();
  const auto residuals = box_residuals(Pose3::exp(twist), {true, true, true}, 0.0, 1);
  const NormalEquations equations = build_normal_equations(residuals);
  const Vector6 step = solve_observable(equations, split_observable(equations, residuals));
  const Pose3 rest = motion_about(equations.centre_m, step) * Pose3::exp(twist);
  EXPECT_LT(rest.log().norm(), 1e-4);
}

TEST(NormalEquations, InformationMatchesNumericalDerivatives) {
  const auto residuals = box_residuals(Pose3::from_translation(0.1, 0.0, 0.0), {true, true, true}, 0.02, 2);
  const NormalEquations equations = build_normal_equations(residuals);
  for (int k = 0; k < 6; ++k) {
    const double h = 1e-6;
    const Vector6 nudge = h * equations.unscale.col(k);
    const Pose3 motion = motion_about(equations.centre_m, nudge);
    double derivative = 0.0;
    for (const PlaneResidual& r : residuals) {
      const double nudged = r.residual_m + r.direction.dot(motion * r.point_m - r.point_m);
      derivative += r.weight * r.residual_m * (nudged - r.residual_m) / h;
    }
    EXPECT_NEAR(derivative, equations.gradient[k], 1e-3 * std::max(1.0, std::abs(equations.gradient[k])));
  }
}

TEST(SplitObservable, NamesTheDirectionThatNoFaceFixes) {
  const auto residuals = box_residuals({}, {false, true, true}, 0.01, 3);
  const NormalEquations equations = build_normal_equations(residuals);
  const ObservableSplit split = split_observable(equations, residuals);
  ASSERT_EQ(split.unobservable, 1);
  EXPECT_GT(std::abs((equations.unscale * split.directions.col(0))[0]), 0.99);
  const Vector6 step = solve_observable(equations, split);
  EXPECT_LT(std::abs(step[0]), 1e-3);
}

// A corridor along x: floor and walls whose normals scatter, and an end wall that few residuals see.
std::vector<PlaneResidual> corridor_residuals(int end_wall, std::uint64_t seed) {
  Rng rng(seed, 0);
  std::vector<PlaneResidual> residuals;
  for (int i = 0; i < 6000; ++i) {
    const int axis = 1 + i % 2;
    Eigen::Vector3d point(rng.uniform(-10, 10), rng.uniform(-1.5, 1.5), rng.uniform(-1.5, 1.5));
    point[axis] = i % 4 < 2 ? 1.5 : -1.5;
    Eigen::Vector3d normal = Eigen::Vector3d::Unit(axis);
    normal += 0.12 * Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal());
    residuals.push_back({point, normal.normalized(), 0.0, 1.0});
  }
  for (int i = 0; i < end_wall; ++i) {
    residuals.push_back({{10.0, rng.uniform(-1.5, 1.5), rng.uniform(-1.5, 1.5)}, Eigen::Vector3d::UnitX(), 0.1, 1.0});
  }
  return residuals;
}

TEST(SplitObservable, AFewVoxelsOfAnEndWallFixACorridor) {
  const auto open = corridor_residuals(0, 6);
  const NormalEquations along = build_normal_equations(open);
  const ObservableSplit free = split_observable(along, open);
  EXPECT_GT(free.shares[0], 0.005) << "normals scatter";
  EXPECT_LT(free.facing[0], 0.001);
  EXPECT_EQ(free.unobservable, 1);
  const auto closed = corridor_residuals(60, 6);
  const NormalEquations equations = build_normal_equations(closed);
  const ObservableSplit fixed = split_observable(equations, closed);
  EXPECT_EQ(fixed.unobservable, 0);
  EXPECT_LT(solve_observable(equations, fixed)[0], -0.01) << "the wall stands 0.1 m off";
}

TEST(SplitBeside, MovesNothingAlongWhatIsHeld) {
  const auto residuals = box_residuals({}, {true, true, true}, 0.01, 5);
  auto shifted = residuals;
  for (PlaneResidual& r : shifted) r.residual_m += r.direction.dot(Eigen::Vector3d(0.1, 0.05, 0.0));
  const NormalEquations equations = build_normal_equations(shifted);
  EXPECT_EQ(split_beside(equations, {}).unobservable, 0);
  Vector6 along_x = Vector6::Zero();
  along_x[0] = 1.0;
  Vector6 along_x_and_z = along_x;
  along_x_and_z[2] = 1.0;
  const std::vector<Vector6> held = {along_x, along_x_and_z};
  const ObservableSplit split = split_beside(equations, held);
  ASSERT_EQ(split.unobservable, 2);
  const Vector6 step = solve_observable(equations, split);
  EXPECT_NEAR(step[0], 0.0, 1e-9);
  EXPECT_NEAR(step[1], -0.05, 0.005);
  EXPECT_NEAR(step[2], 0.0, 1e-9);
}

// A turn about a far point is held as such, wherever the centre of what is matched lies.
TEST(SplitBeside, HoldsMotionsOfTheFrame) {
  const auto residuals = box_residuals({}, {true, true, true}, 0.01, 5);
  const NormalEquations equations = build_normal_equations(residuals);
  const ObservableSplit all = split_beside(equations, {});
  const std::vector<Vector6> held = {motion_of_frame(equations, all.directions.col(3))};
  const ObservableSplit split = split_beside(equations, held);
  ASSERT_EQ(split.unobservable, 1);
  EXPECT_NEAR(std::abs(split.directions.col(0).dot(all.directions.col(3))), 1.0, 1e-9);
}

TEST(BlurCovariance, LiesAlongWhatIsBlurred) {
  const auto residuals = box_residuals({}, {true, true, true}, 0.01, 5);
  const NormalEquations equations = build_normal_equations(residuals);
  ObservableSplit split = split_beside(equations, {});
  split.blur_m[2] = 0.03;
  const Matrix6 scale = equations.unscale.inverse();
  const Matrix6 blur = scale * blur_covariance(equations, split) * scale.transpose();
  EXPECT_NEAR(std::sqrt(blur.trace()), 0.03, 1e-9);
  EXPECT_NEAR(split.directions.col(2).dot(blur * split.directions.col(2)), 0.03 * 0.03, 1e-9);
}

// A thick wall and a thin floor: what the floor fixes is known better, though both are as many.
TEST(OffsetCovariance, FollowsThePatchesOwnResiduals) {
  auto residuals = box_residuals({}, {true, true, true}, 0.02, 5);
  for (PlaneResidual& r : residuals) {
    if (std::abs(r.direction.z()) > 0.9) r.residual_m *= 0.1;
  }
  const NormalEquations equations = build_normal_equations(residuals);
  const ObservableSplit split = split_beside(equations, {});
  const Matrix6 claimed = offset_covariance(residuals, equations, split, {.cell_m = 2.0, .of_residuals = 1.0});
  EXPECT_LT(claimed(2, 2), 0.1 * claimed(0, 0));
  const Matrix6 half = offset_covariance(residuals, equations, split, {.cell_m = 2.0, .of_residuals = 0.5});
  EXPECT_LT((claimed - 2.0 * half).norm(), 1e-9 * claimed.norm());
}

// What moves all patches alike is known less well the fewer of them there are.
TEST(OffsetCovariance, WiderCellsHoldFewerObservations) {
  const auto residuals = box_residuals({}, {true, true, true}, 0.01, 5);
  const NormalEquations equations = build_normal_equations(residuals);
  const ObservableSplit split = split_beside(equations, {});
  const Matrix6 narrow = offset_covariance(residuals, equations, split, {.cell_m = 1.0, .sigma_m = 0.01});
  const Matrix6 wide = offset_covariance(residuals, equations, split, {.cell_m = 8.0, .sigma_m = 0.01});
  for (int axis = 0; axis < 3; ++axis) EXPECT_GT(wide(axis, axis), 1.5 * narrow(axis, axis)) << axis;
}

// Each wall of a box, cut by its lattice, lies off as a whole; no residual shows it.
TEST(PatchCovariance, KnowsOffsetsThatAPatchHasAsAWhole) {
  constexpr double kOffset_m = 0.01;
  constexpr int kTrials = 300;
  const auto plain = box_residuals({}, {true, true, true}, 0.0, 11);
  const NormalEquations equations = build_normal_equations(plain);
  const ObservableSplit split = split_observable(equations, plain);
  const Matrix6 claimed = patch_covariance(plain, equations, split, 2.0, kOffset_m);
  Rng rng(12, 0);
  Vector6 empirical = Vector6::Zero();
  for (int trial = 0; trial < kTrials; ++trial) {
    std::map<std::array<int, 5>, double> offsets;
    auto residuals = plain;
    for (PlaneResidual& r : residuals) {
      const Eigen::Vector3i cell = ((r.point_m - equations.centre_m) / 2.0).array().round().matrix().cast<int>();
      int axis = 0;
      r.direction.cwiseAbs().maxCoeff(&axis);
      const auto [offset, fresh] =
          offsets.try_emplace({cell.x(), cell.y(), cell.z(), axis, r.direction[axis] > 0.0 ? 1 : 0}, 0.0);
      if (fresh) offset->second = kOffset_m * rng.normal();
      r.residual_m = offset->second;
    }
    empirical += solve_observable(build_normal_equations(residuals), split).cwiseAbs2() / kTrials;
  }
  for (int k = 0; k < 6; ++k) EXPECT_NEAR(claimed(k, k) / empirical[k], 1.0, 0.35) << k;
}

TEST(PatchCovariance, IndependentNoiseGivesTheTextbookCovariance) {
  Eigen::Vector3d empirical = Eigen::Vector3d::Zero();
  Eigen::Vector3d claimed = Eigen::Vector3d::Zero();
  constexpr int kTrials = 200;
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto residuals = box_residuals({}, {true, true, true}, 0.02, 100 + static_cast<std::uint64_t>(trial));
    const NormalEquations equations = build_normal_equations(residuals);
    const ObservableSplit split = split_observable(equations, residuals);
    const Vector6 step = solve_observable(equations, split);
    empirical += step.head<3>().cwiseAbs2() / kTrials;
    claimed += patch_covariance(residuals, equations, split, 1.0, 0.0).diagonal().head<3>() / kTrials;
  }
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(claimed[axis] / empirical[axis], 1.0, 0.3);
}

TEST(PriorCovariance, UnobservableDirectionsHoldThePrior) {
  const auto residuals = box_residuals({}, {false, true, true}, 0.01, 4);
  const NormalEquations equations = build_normal_equations(residuals);
  const ObservableSplit split = split_observable(equations, residuals);
  const Matrix6 covariance =
      patch_covariance(residuals, equations, split, 1.0, 0.005) + prior_covariance(equations, split, 0.7, 0.1);
  EXPECT_NEAR(std::sqrt(covariance(0, 0)), 0.7, 0.02);
  EXPECT_LT(std::sqrt(covariance(1, 1)), 0.02);
}

// A floor alone leaves two shifts and a turn free, and solvers any basis of the three.
TEST(PriorCovariance, DoesNotDependOnHowFreeDirectionsAreMixed) {
  const auto residuals = box_residuals({}, {false, false, true}, 0.01, 4);
  const NormalEquations equations = build_normal_equations(residuals);
  ObservableSplit split = split_observable(equations, residuals);
  ASSERT_EQ(split.unobservable, 3);
  for (const double angle : {0.0, 0.4, 0.8}) {
    ObservableSplit mixed = split;
    mixed.directions.leftCols(3) *=
        Eigen::AngleAxisd(angle, Eigen::Vector3d(1.0, 2.0, -0.5).normalized()).toRotationMatrix();
    const Matrix6 covariance = prior_covariance(equations, mixed, 0.7, 0.03);
    EXPECT_NEAR(std::sqrt(covariance(0, 0)), 0.7, 0.01) << angle;
    EXPECT_NEAR(std::sqrt(covariance(1, 1)), 0.7, 0.01) << angle;
    EXPECT_NEAR(std::sqrt(covariance(5, 5)), 0.03, 0.001) << angle;
    EXPECT_LT(std::abs(covariance(0, 5)), 0.01 * 0.7 * 0.03) << angle;
  }
}

TEST(CovarianceInSource, AgreesWithSampling) {
  Rng rng(9, 0);
  const Pose3 T(Eigen::Quaterniond(Eigen::AngleAxisd(0.8, Eigen::Vector3d(1, 2, 0.5).normalized())), {3.0, -1.0, 2.0});
  const Eigen::Vector3d centre(10.0, 4.0, 1.0);
  Vector6 sigmas;
  sigmas << 0.01, 0.02, 0.03, 0.001, 0.002, 0.003;
  const Matrix6 claimed = covariance_in_source(sigmas.cwiseAbs2().asDiagonal(), centre, T);
  Matrix6 sampled = Matrix6::Zero();
  constexpr int kSamples = 20000;
  for (int i = 0; i < kSamples; ++i) {
    Vector6 step;
    for (int k = 0; k < 6; ++k) step[k] = sigmas[k] * rng.normal();
    const Vector6 xi = (T.inverse() * (motion_about(centre, step) * T)).log();
    sampled += xi * xi.transpose() / kSamples;
  }
  EXPECT_LT((sampled - claimed).norm(), 0.05 * claimed.norm());
}

}  // namespace
}  // namespace kilter
