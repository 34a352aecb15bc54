// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "kilter/registration/common_places.h"
#include "kilter/registration/normal_equations.h"
#include "kilter/registration/registration.h"

namespace kilter {

/// Residuals of one facing this near each other share surface, lattice and view: they count as one observation. [m]
inline constexpr double kPatch_m = 2.0;
/// Centroids sit within a tenth of a voxel of the surface they stand for, and a patch may be off by it as a whole.
inline constexpr double kPlanePatchVoxels = 0.1;

/// M of the mean square x^T M x by which a motion x = (v, w) displaces places whose arms from its centre have this mean
/// and this second moment.
[[nodiscard]] Matrix6 displacement_form(const Eigen::Vector3d& arm_m, const Eigen::Matrix3d& scatter_m2);

/// What is known of a pose that planes fix, as a covariance of (v, w) on the observable directions: patches of surface
/// lie off by what their own residuals scatter, what lies within one part of a bend is off alike, and what fits
/// anywhere blurs.
[[nodiscard]] Matrix6 plane_covariance(std::span<const PlaneResidual> residuals, const NormalEquations& equations,
                                       const ObservableSplit& split, const Bend& bend);

/// Fills in what a finished registration says about itself: centre and scatter of the places, covariances,
/// unobservable directions. `result.T_target_source` and `result.covariance_measured` must be set.
void describe_uncertainty(const PlaceMoments& places, const NormalEquations& equations, const ObservableSplit& split,
                          const RegistrationPrior& prior, RegistrationResult& result);

/// The covariance of a registration as a constraint between two submaps that move as one body each, of
/// T_target_source * Exp(xi), xi = (x y z rx ry rz). Where no rigid motion mends the pair, what its bend leaves apart
/// is not known of the bodies either: a motion that displaces the common places by the bend's RMS, as likely in each of
/// the six directions of x^T M x, comes on top of what the registration claims. \param rigid  whether the bend is small
/// enough not to count \param scale  of what was measured, from cycles of registrations (close_cycles)
[[nodiscard]] Matrix6 constraint_covariance(const RegistrationResult& registration, bool rigid, double scale);

}  // namespace kilter
