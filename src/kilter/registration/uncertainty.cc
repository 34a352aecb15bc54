// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/uncertainty.h"

namespace kilter {

Matrix6 displacement_form(const Eigen::Matrix3d& scatter_m2) {
  Matrix6 M = Matrix6::Identity();
  M.bottomRightCorner<3, 3>() = scatter_m2.trace() * Eigen::Matrix3d::Identity() - scatter_m2;
  return M;
}

void describe_uncertainty(std::span<const PlaneResidual> residuals, const NormalEquations& equations,
                          const ObservableSplit& split, double patch_sigma_m, const RegistrationPrior& prior,
                          RegistrationResult& result) {
  result.centre_target_m = equations.centre_m;
  result.scatter_m2 = scatter_about(residuals, equations.centre_m);
  result.covariance_measured = patch_covariance(residuals, equations, split, kPatch_m, patch_sigma_m);
  result.covariance_centre =
      result.covariance_measured + prior_covariance(equations, split, prior.translation_m, prior.rotation_rad);
  result.covariance = covariance_in_source(result.covariance_centre, equations.centre_m, result.T_target_source);
  for (int k = 0; k < split.unobservable; ++k) {
    result.unobservable.emplace_back((equations.unscale * split.directions.col(k)).normalized());
  }
}

}  // namespace kilter
