// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
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
  std::uint8_t source_at = 0;  ///< when the source saw it (SurfaceVoxels::seen_at)
  std::uint8_t target_at = 0;
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

/// Eigenvectors of information / weight, those that the scene does not fix first.
struct ObservableSplit {
  Vector6 shares = Vector6::Zero();  ///< eigenvalues; 1/3 each for translations of a cube
  Vector6 facing = Vector6::Zero();  ///< the part of them from residuals that face the motion, where that was asked
  Matrix6 directions = Matrix6::Zero();
  Vector6 blur_m = Vector6::Zero();  ///< standard deviation by what fits at any shift along a direction, if known
  int unobservable = 0;              ///< how many of the first columns are not fixed
};

/// A direction whose share is at least this is fixed. Normals fitted to 0.1 m voxels scatter by 5 to 8 degrees, so a
/// direction that no surface faces still collects sin^2(8 deg) = 0.02 of the weight: three times as much is above
/// doubt.
inline constexpr double kEnoughShare = 0.06;

/// Least cosine between a normal and the way that its point would go, for the surface to face the motion: 66 degrees,
/// three standard deviations of a voxel's normal.
inline constexpr double kFacingCosine = 0.4;

/// Whether a surface of this normal faces the way that its point goes, forwards or backwards; not where it stays.
[[nodiscard]] inline bool faces(const Eigen::Vector3d& normal, const Eigen::Vector3d& way_m) {
  return std::abs(normal.dot(way_m)) > kFacingCosine * way_m.norm();
}

/// A direction is fixed by surfaces that face its motion, few as they may be: the end wall of a corridor is a hundredth
/// of what is seen there. What surfaces along the motion add to the information is noise of their normals, so only
/// residuals whose normal lies within 66 degrees of the way that their point would move are counted (three standard
/// deviations of a voxel's normal), and what they add has to exceed what clutter of all directions adds.
[[nodiscard]] ObservableSplit split_observable(const NormalEquations& equations,
                                               std::span<const PlaneResidual> residuals);

/// The split where it is known what is not fixed: `held` are motions v0 + w x p of the target frame.
[[nodiscard]] ObservableSplit split_beside(const NormalEquations& equations, std::span<const Vector6> held);

/// The motion v0 + w x p of the target frame that a direction of the scaled unknowns stands for.
[[nodiscard]] Vector6 motion_of_frame(const NormalEquations& equations, const Vector6& direction);

/// The part of a motion (v, w) about the centre that lies along the observable directions.
[[nodiscard]] Vector6 fixed_part(const NormalEquations& equations, const ObservableSplit& split, const Vector6& motion);

/// The step (v [m], w [rad]) that solves the equations on the observable directions, zero along the others.
[[nodiscard]] Vector6 solve_observable(const NormalEquations& equations, const ObservableSplit& split);

/// Covariance of (v, w) about the centre, target axes, on the observable directions. Residuals of one patch, that is
/// of one cell of `cell_m` and one facing (the nearest of 26), are taken as one observation, in two ways that add up:
///  - a sandwich over the patches' sums, for what shows in the residuals: noise, clutter, bends within reach;
///  - `patch_sigma_m` for what does not: all voxels of a surface cut it at much the same height, and a patch so lies
///    off as a whole; residuals of a fit that follows it are small all the same.
/// So a direction that few surfaces fix is known less well than one that many do.
[[nodiscard]] Matrix6 patch_covariance(std::span<const PlaneResidual> residuals, const NormalEquations& equations,
                                       const ObservableSplit& split, double cell_m, double patch_sigma_m);

/// How far patches (as above) lie off as a whole, each on its own: variances that add up.
struct PatchOffsets {
  double cell_m = 2.0;
  double of_residuals = 0.0;  ///< share of the patch's own mean square residual
  double sigma_m = 0.0;
};

/// The same where nothing but these offsets moves the solution: floors seen at grazing angles are thin, and so are
/// their offsets; walls hit head-on, foliage and cars are thick.
[[nodiscard]] Matrix6 offset_covariance(std::span<const PlaneResidual> residuals, const NormalEquations& equations,
                                        const ObservableSplit& split, const PatchOffsets& offsets);

/// The same where surfaces lie off by what the cells hide that their points are the centres of: a plane that runs along
/// the lattice as a whole, one that crosses it at a slant differently from place to place; half of the variance each.
/// A plane is what faces alike and lies in one layer of a metre. Few planes are no better than one, however many
/// voxels show them.
[[nodiscard]] Matrix6 cell_covariance(std::span<const PlaneResidual> residuals, const NormalEquations& equations,
                                      const ObservableSplit& split, double variance_m2);

/// What blurs the observable directions, as a covariance of (v, w).
[[nodiscard]] Matrix6 blur_covariance(const NormalEquations& equations, const ObservableSplit& split);

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
