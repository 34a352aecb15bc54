// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/uncertainty.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "kilter/registration/patches.h"

namespace kilter {
namespace {

// Of the residuals' mean square in a patch: by this much it lies off as a whole. Seen where the truth is known, alike
// on floors and walls of three worlds; all voxels of a surface cut it at much the same height, so their number is no
// help. Less where a bend was followed through time: of the step that was not believed there, the whole is added.
constexpr double kPatchShare = 0.6;
constexpr double kPatchShareInTime = 0.45;
// And never by less: two submaps of the same scans have no residuals, and are not known without bounds.
constexpr double kLeastPatch_m = 1e-4;
// A bend is smooth: what lies this near each other is off alike. [m]
constexpr double kBendCell_m = 8.0;
// A bend is the length of a displacement, mostly level: half its square along each level axis. Where it was followed
// through time, the pose is the one that leaves the least of it, as far as it is beyond noise, and a hundredth is left.
// Chosen on an office's and a car park's missions with drift, where without any of it constraints are off by what their
// covariances say in the median, and by more in the mean.
constexpr double kBendShare = 0.5;
constexpr double kBendShareInTime = 0.01;

}  // namespace

Matrix6 displacement_form(const Eigen::Vector3d& arm_m, const Eigen::Matrix3d& scatter_m2) {
  // |v + w x a|^2 = |v|^2 + 2 w . (a x v) + |w|^2 |a|^2 - (w . a)^2
  Matrix6 M = Matrix6::Identity();
  M.bottomLeftCorner<3, 3>() << 0.0, -arm_m.z(), arm_m.y(), arm_m.z(), 0.0, -arm_m.x(), -arm_m.y(), arm_m.x(), 0.0;
  M.topRightCorner<3, 3>() = M.bottomLeftCorner<3, 3>().transpose();
  M.bottomRightCorner<3, 3>() = scatter_m2.trace() * Eigen::Matrix3d::Identity() - scatter_m2;
  return M;
}

Matrix6 plane_covariance(std::span<const PlaneResidual> residuals, const NormalEquations& equations,
                         const ObservableSplit& split, const Bend& bend) {
  const bool in_time = bend.kind != BendKind::kSpace;
  const PatchOffsets of_surfaces{
      .cell_m = kPatch_m, .of_residuals = in_time ? kPatchShareInTime : kPatchShare, .sigma_m = kLeastPatch_m};
  const double share = in_time ? kBendShareInTime : kBendShare;
  const PatchOffsets of_bend{.cell_m = kBendCell_m, .sigma_m = std::sqrt(share) * bend.rms_m};
  return offset_covariance(residuals, equations, split, of_surfaces) +
         offset_covariance(residuals, equations, split, of_bend) + blur_covariance(equations, split);
}

void describe_uncertainty(const PlaceMoments& places, const NormalEquations& equations, const ObservableSplit& split,
                          const RegistrationPrior& prior, RegistrationResult& result) {
  result.centre_target_m = equations.centre_m;
  if (places.count > 0) result.places_arm_m = places.mean_m - equations.centre_m;
  result.scatter_m2 = places.scatter_m2 + result.places_arm_m * result.places_arm_m.transpose();
  result.covariance_centre =
      result.covariance_measured + prior_covariance(equations, split, prior.translation_m, prior.rotation_rad);
  result.covariance = covariance_in_source(result.covariance_centre, equations.centre_m, result.T_target_source);
  for (int k = 0; k < split.unobservable; ++k) {
    Vector6 twist = equations.unscale * split.directions.col(k);
    twist.head<3>() += twist.tail<3>().cross(result.places_arm_m);
    result.unobservable.push_back(twist.normalized());
  }
}

Matrix6 constraint_covariance(const RegistrationResult& registration, bool rigid, double scale) {
  Matrix6 covariance = registration.covariance_centre + (scale - 1.0) * registration.covariance_measured;
  if (!rigid) {
    // A place has an extent, so the form has an inverse even where all of them lie on a line.
    Matrix6 M = displacement_form(registration.places_arm_m, registration.scatter_m2);
    M.bottomRightCorner<3, 3>().diagonal().array() += registration.place_m * registration.place_m / 6.0;
    covariance += std::pow(registration.bend.rms_m, 2) / 6.0 * M.ldlt().solve(Matrix6::Identity());
  }
  return covariance_in_source(covariance, registration.centre_target_m, registration.T_target_source);
}

}  // namespace kilter
