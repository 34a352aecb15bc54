// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/verification/offset.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "kilter/base/contract.h"
#include "kilter/numerics/special.h"
#include "kilter/registration/uncertainty.h"

namespace kilter {
namespace {

// Two one-sided 5 % points of the normal law: told from zero at 5 %, found with 95 %.
constexpr double kDetection = 1.6448536269514722 + 1.6448536269514722;

// `square_m2` is what is known of it without noise.
OffsetEstimate::SquareLaw square_law(double square_m2, const Vector6& x, const Matrix6& M, const Matrix6& covariance) {
  const Matrix6 MC = M * covariance;
  return {square_m2 + MC.trace(), 2.0 * (MC * MC).trace() + 4.0 * x.dot(MC * (M * x))};
}

// Mean over the places of |v + (I - R^T) a|^2, where the motion ends at each: v at the centre, a the place from there.
// x^T M x is the same for small turns; of 30 degrees it may be a tenth short.
double mean_square_m2(const Eigen::Vector3d& v_m, const Eigen::Quaterniond& R, const Eigen::Vector3d& arm_m,
                      const Eigen::Matrix3d& scatter_m2) {
  const Eigen::Matrix3d turn = Eigen::Matrix3d::Identity() - R.conjugate().toRotationMatrix();
  const double square_m2 =
      v_m.squaredNorm() + 2.0 * v_m.dot(turn * arm_m) + (turn * scatter_m2 * turn.transpose()).trace();
  return std::max(square_m2, 0.0);
}

double largest_sigma_m(const Matrix6& M, const Matrix6& covariance) {
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(M);
  const Matrix6 root = solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
                       solver.eigenvectors().transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix6> spread(root * covariance * root);
  return std::sqrt(std::max(spread.eigenvalues().maxCoeff(), 0.0));
}

// Degrees of freedom of the scaled chi-square, and the limit as a standard normal deviate (Wilson-Hilferty).
double normal_deviate(const OffsetEstimate::SquareLaw& law, double limit_m) {
  const double share = law.variance_m4 / (9.0 * law.mean_m2 * law.mean_m2);  // 2 / (9 nu)
  return (std::cbrt(limit_m * limit_m / law.mean_m2) - (1.0 - share)) / std::sqrt(share);
}

// Inverse of the normal tail by bisection on log_normal_tail; called a few times a pair.
double deviate_of_tail(double tail) {
  double low = -40.0;
  double high = 40.0;
  for (int i = 0; i < 80; ++i) {
    const double middle = 0.5 * (low + high);
    (log_normal_tail(middle) > std::log(tail) ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

OffsetEstimate estimate_offset(const RegistrationResult& registration, const Pose3& T_target_source_map) {
  KILTER_EXPECTS(registration.converged());
  const Pose3 moved = registration.T_target_source * T_target_source_map.inverse();
  // The centre was found at the registered pose; the same place in the map's pose is where the motion starts.
  const Eigen::Vector3d start_m = moved.inverse() * registration.centre_target_m;
  Vector6 x;
  x.head<3>() = registration.centre_target_m - start_m;
  x.tail<3>() = moved.log().tail<3>();
  const Matrix6 M = displacement_form(registration.places_arm_m, registration.scatter_m2);
  OffsetEstimate estimate;
  const double square_m2 =
      mean_square_m2(x.head<3>(), moved.rotation(), registration.places_arm_m, registration.scatter_m2);
  estimate.offset_m = std::sqrt(square_m2);
  estimate.offset_rad = x.tail<3>().norm();
  const Eigen::Vector3d places_m = registration.centre_target_m + registration.places_arm_m;
  estimate.vector_m = places_m - moved.inverse() * places_m;
  estimate.measured = square_law(square_m2, x, M, registration.covariance_measured);
  estimate.with_prior = square_law(square_m2, x, M, registration.covariance_centre);
  const double largest_m = largest_sigma_m(M, registration.covariance_measured);
  const double along_m4 = x.dot(M * registration.covariance_measured * M * x);
  estimate.sigma_m = estimate.offset_m > 0.0 ? std::sqrt(std::max(along_m4, 0.0)) / estimate.offset_m : largest_m;
  estimate.minimum_detectable_m = kDetection * largest_m;
  estimate.cells_sigma_m = std::sqrt(std::max((M * registration.covariance_cells).trace(), 0.0));
  estimate.hidden_sigma_m =
      std::sqrt(std::max((M * (registration.covariance_centre - registration.covariance_measured)).trace(), 0.0));
  return estimate;
}

double places_scatter(const Bend& bend) {
  return bend.kind == BendKind::kSpace ? kMatchedPlacesScatter : kPlacesScatter;
}

OffsetEstimate::SquareLaw disagreement_law(const OffsetEstimate::SquareLaw& offset, const Bend& bend) {
  const double mean_m2 = offset.mean_m2 + bend.rms_m * bend.rms_m;
  const double places_m2 = 2.0 * places_scatter(bend) * mean_m2;
  return {mean_m2, offset.variance_m4 + bend.variance_m4 + places_m2 * places_m2};
}

LogTails log_tails(const OffsetEstimate::SquareLaw& law, double limit_m) {
  KILTER_EXPECTS(law.mean_m2 > 0.0 && law.variance_m4 > 0.0);
  const double z = normal_deviate(law, limit_m);
  return {log_normal_tail(z), log_normal_tail(-z)};
}

LogTails log_tails_with_hidden(const OffsetEstimate::SquareLaw& measured, const OffsetEstimate::SquareLaw& with_prior,
                               double limit_m) {
  const LogTails seen = log_tails(measured, limit_m);
  const LogTails all = log_tails(with_prior, limit_m);
  return {std::max(seen.above, all.above), std::min(seen.below, all.below)};
}

double offset_quantile_m(const OffsetEstimate::SquareLaw& law, double tail) {
  KILTER_EXPECTS(tail > 0.0 && tail < 1.0);
  const double share = law.variance_m4 / (9.0 * law.mean_m2 * law.mean_m2);
  const double root = std::max(1.0 - share + deviate_of_tail(tail) * std::sqrt(share), 0.0);
  return std::sqrt(law.mean_m2 * root * root * root);
}

}  // namespace kilter
