// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/verification/offset.h"

#include <gtest/gtest.h>

#include <cmath>

#include "kilter/base/rng.h"

namespace kilter {
namespace {

RegistrationResult registered(const Pose3& T, double sigma_m, double sigma_rad) {
  RegistrationResult result;
  result.stop = StopReason::kConverged;
  result.T_target_source = T;
  result.centre_target_m = {5.0, 1.0, 0.5};
  result.scatter_m2 = Eigen::Vector3d(9.0, 4.0, 1.0).asDiagonal();
  Vector6 variances;
  variances << Eigen::Vector3d::Constant(sigma_m * sigma_m), Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
  result.covariance_measured = variances.asDiagonal();
  result.covariance_centre = result.covariance_measured;
  return result;
}

TEST(EstimateOffset, PureTranslationIsItsLength) {
  const RegistrationResult result = registered(Pose3::from_translation(0.3, 0.0, 0.4), 0.01, 0.001);
  const OffsetEstimate offset = estimate_offset(result, {});
  EXPECT_NEAR(offset.offset_m, 0.5, 1e-12);
  EXPECT_NEAR(offset.vector_m.x(), 0.3, 1e-12);
  EXPECT_NEAR(offset.offset_rad, 0.0, 1e-12);
  EXPECT_NEAR(offset.sigma_m, 0.01, 1e-9);
}

// The middle of what fixes the pose need not be that of the places.
TEST(EstimateOffset, PlacesBesideTheCentreMoveWithTheTurn) {
  const Eigen::Vector3d centre(5.0, 1.0, 0.5);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitZ()));
  RegistrationResult result = registered({turn, centre - turn * centre + Eigen::Vector3d(0.0, 0.1, 0.0)}, 0.01, 0.001);
  result.places_arm_m = {10.0, 0.0, 0.0};
  result.scatter_m2 = Eigen::Vector3d(100.0, 0.0, 0.0).asDiagonal();  // all of them 10 m ahead
  EXPECT_NEAR(estimate_offset(result, {}).offset_m, 0.1 + 0.02 * 10.0, 1e-3);
  EXPECT_NEAR(estimate_offset(result, {}).vector_m.y(), 0.1 + 0.02 * 10.0, 1e-3);  // there, and not at the centre
  result.places_arm_m = {-10.0, 0.0, 0.0};
  EXPECT_NEAR(estimate_offset(result, {}).offset_m, 0.1, 1e-3);
}

TEST(EstimateOffset, TheVectorIsExactForLargeTurns) {
  const Pose3 moved(Eigen::Quaterniond(Eigen::AngleAxisd(0.6, Eigen::Vector3d::UnitZ())), {0.4, -0.2, 0.1});
  RegistrationResult result = registered(moved, 0.01, 0.001);
  result.places_arm_m = {2.0, -1.0, 0.3};
  const Eigen::Vector3d place_m = result.centre_target_m + result.places_arm_m;
  EXPECT_NEAR((moved.inverse() * place_m + estimate_offset(result, {}).vector_m - place_m).norm(), 0.0, 1e-12);
}

// Places beside the centre, a turn of 31 degrees: what each of eight moves, counted one by one.
TEST(EstimateOffset, IsTheRootMeanSquareForLargeTurnsToo) {
  const Pose3 moved(Eigen::Quaterniond(Eigen::AngleAxisd(0.55, Eigen::Vector3d::UnitZ())), {3.0, 0.4, -0.1});
  RegistrationResult result = registered(moved, 0.01, 0.001);
  result.scatter_m2.setZero();
  double square_m2 = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d arm_m(6.0 + ((corner & 1) - 0.5), (corner & 2) - 1.0, 0.25 * (corner & 4));
    const Eigen::Vector3d place_m = result.centre_target_m + arm_m;
    result.places_arm_m += arm_m / 8.0;
    result.scatter_m2 += arm_m * arm_m.transpose() / 8.0;
    square_m2 += (place_m - moved.inverse() * place_m).squaredNorm() / 8.0;
  }
  const OffsetEstimate offset = estimate_offset(result, {});
  EXPECT_NEAR(offset.offset_m, std::sqrt(square_m2), 1e-9);
  EXPECT_LE(offset.vector_m.norm(), offset.offset_m);
}

TEST(EstimateOffset, RotationCountsByTheSpreadOfThePlaces) {
  // Turn about the vertical through the overlap's centre: mean square arm from that axis is 9 + 4.
  const Eigen::Vector3d centre(5.0, 1.0, 0.5);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitZ()));
  const RegistrationResult result = registered({turn, centre - turn * centre}, 0.01, 0.001);
  const OffsetEstimate offset = estimate_offset(result, {});
  EXPECT_NEAR(offset.offset_m, 0.02 * std::sqrt(13.0), 1e-5);
  EXPECT_NEAR(offset.offset_rad, 0.02, 1e-9);
  EXPECT_NEAR(offset.vector_m.norm(), 0.0, 1e-9);
}

TEST(EstimateOffset, TailsAndQuantilesAgreeWithSampling) {
  const RegistrationResult result = registered(Pose3::from_translation(0.06, 0.03, 0.0), 0.02, 0.004);
  const OffsetEstimate offset = estimate_offset(result, {});
  Rng rng(1, 0);
  int above = 0;
  std::vector<double> offsets;
  constexpr int kSamples = 40000;
  for (int i = 0; i < kSamples; ++i) {
    const Eigen::Vector3d v =
        Eigen::Vector3d(0.06, 0.03, 0.0) + 0.02 * Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal());
    const Eigen::Vector3d w = 0.004 * Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal());
    const double square = v.squaredNorm() + 5.0 * w.x() * w.x() + 10.0 * w.y() * w.y() + 13.0 * w.z() * w.z();
    offsets.push_back(std::sqrt(square));
    above += std::sqrt(square) > 0.1 ? 1 : 0;
  }
  std::sort(offsets.begin(), offsets.end());
  EXPECT_NEAR(std::exp(log_tails(offset.measured, 0.1).above), static_cast<double>(above) / kSamples, 0.01);
  EXPECT_NEAR(offset_quantile_m(offset.measured, 0.025), offsets[static_cast<std::size_t>(0.975 * kSamples)], 0.002);
  EXPECT_NEAR(offset_quantile_m(offset.measured, 0.975), offsets[static_cast<std::size_t>(0.025 * kSamples)], 0.004);
  const LogTails tails = log_tails(offset.measured, 0.1);
  EXPECT_NEAR(std::exp(tails.above) + std::exp(tails.below), 1.0, 1e-12);
}

TEST(EstimateOffset, MovingTheTargetFrameChangesNoLength) {
  const Pose3 T_map = Pose3::from_translation(1.0, 2.0, 0.0);
  const Pose3 moved = Pose3::exp((Vector6() << 0.1, -0.05, 0.02, 0.01, 0.0, 0.03).finished());
  RegistrationResult result = registered(moved * T_map, 0.01, 0.001);
  const OffsetEstimate here = estimate_offset(result, T_map);
  const Pose3 frame(Eigen::Quaterniond(Eigen::AngleAxisd(1.0, Eigen::Vector3d(1, 1, 1).normalized())), {7.0, 8.0, 9.0});
  const Eigen::Matrix3d R = frame.rotation_matrix();
  result.T_target_source = frame * result.T_target_source;
  result.centre_target_m = frame * result.centre_target_m;
  result.scatter_m2 = R * result.scatter_m2 * R.transpose();
  const OffsetEstimate there = estimate_offset(result, frame * T_map);
  EXPECT_NEAR(here.offset_m, there.offset_m, 1e-9);
  EXPECT_NEAR(here.offset_rad, there.offset_rad, 1e-9);
}

// A tunnel: 25 cm across it are sure, half a metre along it is the prior's.
TEST(LogTailsWithHidden, WhatNothingFixesOnlyAddsToWhatIsMeasured) {
  RegistrationResult result = registered(Pose3::from_translation(0.25, 0.0, 0.0), 0.005, 0.0005);
  result.covariance_centre(1, 1) += 0.25;
  const OffsetEstimate offset = estimate_offset(result, {});
  EXPECT_GT(std::exp(log_tails(offset.with_prior, 0.1).below), 0.05) << "two moments know no better";
  const LogTails tails = log_tails_with_hidden(offset.measured, offset.with_prior, 0.1);
  EXPECT_LT(tails.below, std::log(1e-6));
  EXPECT_GT(tails.above, std::log(0.999));
  // Where next to nothing is measured, what is hidden decides.
  result = registered(Pose3::from_translation(0.01, 0.0, 0.0), 0.005, 0.0005);
  result.covariance_centre(1, 1) += 0.25;
  const OffsetEstimate still = estimate_offset(result, {});
  EXPECT_EQ(log_tails_with_hidden(still.measured, still.with_prior, 0.1).above, log_tails(still.with_prior, 0.1).above);
}

TEST(DisagreementLaw, BendsAddTheirSquaresAndTheirDoubt) {
  const OffsetEstimate::SquareLaw offset{0.04, 1e-6};
  const Bend bend{.rms_m = 0.3, .variance_m4 = 4e-6};
  const OffsetEstimate::SquareLaw law = disagreement_law(offset, bend);
  EXPECT_NEAR(law.mean_m2, 0.13, 1e-12);
  EXPECT_NEAR(law.variance_m4, 5e-6 + std::pow(2.0 * kMatchedPlacesScatter * 0.13, 2), 1e-12);
  EXPECT_GT(log_tails(law, 0.25).above, log_tails(disagreement_law(offset, {}), 0.25).above);
}

}  // namespace
}  // namespace kilter
