// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "kilter/geometry/pose3.h"

namespace kilter {

/// One linearised residual: how far a source point lies off its target along `direction`.
struct PlaneResidual {
  Eigen::Vector3d point_m;    ///< transformed source point, target frame
  Eigen::Vector3d direction;  ///< unit
  double residual_m = 0.0;
  double weight = 1.0;
};

/// Weighted least squares over small motions (v, w) about a centre: p -> c + Exp(w) (p - c) + v, target axes. Solved
/// in scaled unknowns s with (v, w) = unscale * s: the points' principal axes, and each rotation multiplied by the RMS
/// distance of the points from its axis, so that all six are lengths and their information compares (a roll moves the
/// walls of a corridor by far less than a pitch does).
struct NormalEquations {
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();  ///< weighted mean of the points
  Matrix6 unscale = Matrix6::Identity();               ///< scaled unknowns -> (v [m], w [rad]), target axes
  Matrix6 information = Matrix6::Zero();               ///< sum w J J^T over scaled unknowns
  Vector6 gradient = Vector6::Zero();                  ///< sum w J r over scaled unknowns
  double weight = 0.0;                                 ///< sum w
  double squares_m2 = 0.0;                             ///< sum w r^2
};

[[nodiscard]] NormalEquations build_normal_equations(std::span<const PlaneResidual> residuals);

/// Eigenvectors of information / weight, split at a share that honest noise in the normals alone would give.
struct ObservableSplit {
  Vector6 shares = Vector6::Zero();    ///< eigenvalues, ascending; 1/3 each for translations of a cube
  Matrix6 directions = Matrix6::Zero();
  int unobservable = 0;                ///< how many of the first columns are not fixed
};

[[nodiscard]] ObservableSplit split_observable(const NormalEquations& equations);

/// The step (v [m], w [rad]) that solves the equations on the observable directions, zero along the others.
[[nodiscard]] Vector6 solve_observable(const NormalEquations& equations, const ObservableSplit& split);

/// Covariance of (v, w) about the centre, target axes, on the observable directions: sandwich estimate with residuals
/// of one metre-sized cell taken as one observation (they share noise, lattice and plane), plus `floor_m` squared.
[[nodiscard]] Matrix6 cluster_covariance(std::span<const PlaneResidual> residuals, const NormalEquations& equations,
                                         const ObservableSplit& split, double cell_m, double floor_m);

/// What a prior of independent (v, w) leaves along the directions that the scene does not fix; zero elsewhere.
[[nodiscard]] Matrix6 prior_covariance(const NormalEquations& equations, const ObservableSplit& split,
                                       double prior_translation_m, double prior_rotation_rad);

/// How many residuals are smaller than `limit_m`.
[[nodiscard]] std::size_t count_below(std::span<const PlaneResidual> residuals, double limit_m);

/// Mean of (p - centre)(p - centre)^T, unweighted. [m^2]
[[nodiscard]] Eigen::Matrix3d scatter_about(std::span<const PlaneResidual> residuals, const Eigen::Vector3d& centre_m);

/// Moves a covariance of (v, w) about `centre_m` in the target frame to T * Exp(xi) in the source's frame.
[[nodiscard]] Matrix6 covariance_in_source(const Matrix6& about_centre, const Eigen::Vector3d& centre_m,
                                           const Pose3& T_target_source);

/// The rigid motion of the target frame that (v, w) about the centre stands for.
[[nodiscard]] Pose3 motion_about(const Eigen::Vector3d& centre_m, const Vector6& step);

}  // namespace kilter
