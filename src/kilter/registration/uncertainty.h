// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "kilter/registration/normal_equations.h"
#include "kilter/registration/registration.h"

namespace kilter {

/// Fills in what a finished registration says about itself: centre and scatter of the matched voxels, covariances,
/// unobservable directions. `result.T_target_source` must be set. `patch_sigma_m` is how far a
/// patch of surface may lie off as a whole. [m]
void describe_uncertainty(std::span<const PlaneResidual> residuals, const NormalEquations& equations,
                          const ObservableSplit& split, double patch_sigma_m, const RegistrationPrior& prior,
                          RegistrationResult& result);

}  // namespace kilter
