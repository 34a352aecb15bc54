// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "kilter/registration/normal_equations.h"
#include "kilter/registration/registration.h"

namespace kilter {

/// Residuals of one facing this near each other share surface, lattice and view: they count as one observation. [m]
inline constexpr double kPatch_m = 2.0;
/// Centroids sit within a tenth of a voxel of the surface they stand for, and a patch may be off by it as a whole.
inline constexpr double kPlanePatchVoxels = 0.1;

/// M of the mean square x^T M x by which a motion x = (v, w) displaces places of this scatter about its centre.
[[nodiscard]] Matrix6 displacement_form(const Eigen::Matrix3d& scatter_m2);

/// Fills in what a finished registration says about itself: centre and scatter of the matched voxels, covariances,
/// unobservable directions. `result.T_target_source` must be set. `patch_sigma_m` is how far a
/// patch of surface may lie off as a whole. [m]
void describe_uncertainty(std::span<const PlaneResidual> residuals, const NormalEquations& equations,
                          const ObservableSplit& split, double patch_sigma_m, const RegistrationPrior& prior,
                          RegistrationResult& result);

}  // namespace kilter
