// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/normal_equations.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "kilter/registration/patches.h"
#include "kilter/registration/sum_jacobians.h"

namespace kilter {
namespace {

// Below kEnoughShare, what residuals that face the motion add. Clutter of all directions adds up to 0.25 %.
constexpr double kLeastFacing = 0.003;
// Where a plane crosses a lattice at a slant, what the cells hide changes within this. [m]
constexpr double kSlant_m = 8.0;
constexpr double kSlantShare = 0.5;
// Below this share of the weight a direction is not fixed by anything.
constexpr double kNothing = 1e-9;

// Principal axes of the points and, for each, the inverse RMS distance of the points from it.
Matrix6 scaling_of(const Eigen::Matrix3d& scatter_m2) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter_m2);
  const Eigen::Vector3d spread_m2 = solver.eigenvalues().cwiseMax(0.0);
  const Eigen::Vector3d radii_m = (Eigen::Vector3d::Constant(spread_m2.sum()) - spread_m2).cwiseSqrt().cwiseMax(1e-3);
  Matrix6 unscale = Matrix6::Zero();
  unscale.topLeftCorner<3, 3>() = solver.eigenvectors();
  unscale.bottomRightCorner<3, 3>() = solver.eigenvectors() * radii_m.cwiseInverse().asDiagonal();
  return unscale;
}

Matrix6 observable_inverse(const NormalEquations& equations, const ObservableSplit& split) {
  Matrix6 inverse = Matrix6::Zero();
  for (int k = split.unobservable; k < 6; ++k) {
    const Vector6 direction = split.directions.col(k);
    inverse += direction * direction.transpose() / (split.shares[k] * equations.weight);
  }
  return inverse;
}

ObservableSplit nothing_fixed() {
  ObservableSplit split;
  split.unobservable = 6;
  split.directions = Matrix6::Identity();
  return split;
}

// The gradients that offsets of 1 m make, each patch's on its own.
Matrix6 pulls_of(std::span<const Patch> patches) {
  Matrix6 pulls = Matrix6::Zero();
  for (const Patch& patch : patches) pulls += patch.pull * patch.pull.transpose();
  return pulls;
}

// What the solution does where gradients have this covariance, as (v, w).
Matrix6 solved_covariance(const NormalEquations& equations, const ObservableSplit& split, const Matrix6& gradients) {
  const Matrix6 inverse = equations.unscale * observable_inverse(equations, split);
  return inverse * gradients * inverse.transpose();
}

// What the residuals that face the motion along a unit direction of the scaled unknowns add to its share.
double facing_share(std::span<const PlaneResidual> residuals, const NormalEquations& equations,
                    const Vector6& direction) {
  const Vector6 motion = equations.unscale * direction;
  const Eigen::Vector3d shift = motion.head<3>();
  const Eigen::Vector3d turn = motion.tail<3>();
  double sum = 0.0;
  for (const PlaneResidual& r : residuals) {
    const Eigen::Vector3d moved = shift + turn.cross(r.point_m - equations.centre_m);
    const double along = r.direction.dot(moved);
    if (faces(r.direction, moved)) sum += r.weight * along * along;
  }
  return sum / equations.weight;
}

}  // namespace

NormalEquations build_normal_equations(std::span<const PlaneResidual> residuals) {
  NormalEquations equations;
  for (const PlaneResidual& r : residuals) {
    equations.weight += r.weight;
    equations.centre_m += r.weight * r.point_m;
    equations.squares_m2 += r.weight * r.residual_m * r.residual_m;
  }
  if (!(equations.weight > 0.0)) return equations;
  equations.centre_m /= equations.weight;
  Eigen::Matrix3d scatter_m2 = Eigen::Matrix3d::Zero();
  for (const PlaneResidual& r : residuals) {
    const Eigen::Vector3d arm_m = r.point_m - equations.centre_m;
    scatter_m2.noalias() += r.weight * arm_m * arm_m.transpose();
  }
  equations.unscale = scaling_of(scatter_m2 / equations.weight);
  static const SumJacobians kSumJacobians = sum_jacobians_with(vector_paths().back());
  const JacobianSums sums = kSumJacobians(residuals, equations.centre_m);
  equations.information = equations.unscale.transpose() * sums.information * equations.unscale;
  equations.gradient = equations.unscale.transpose() * sums.gradient;
  return equations;
}

ObservableSplit split_observable(const NormalEquations& equations, std::span<const PlaneResidual> residuals) {
  if (!(equations.weight > 0.0)) return nothing_fixed();
  ObservableSplit split;
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(equations.information / equations.weight);
  split.shares = solver.eigenvalues();
  split.directions = solver.eigenvectors();
  split.facing = split.shares;
  for (int k = 0; k < 6 && split.shares[k] < kEnoughShare; ++k) {
    split.facing[k] = facing_share(residuals, equations, split.directions.col(k));
    if (split.facing[k] >= kLeastFacing) continue;
    // To the front, the others keep their order.
    for (int j = k; j > split.unobservable; --j) {
      std::swap(split.shares[j], split.shares[j - 1]);
      std::swap(split.facing[j], split.facing[j - 1]);
      split.directions.col(j).swap(split.directions.col(j - 1));
    }
    ++split.unobservable;
  }
  return split;
}

ObservableSplit split_beside(const NormalEquations& equations, std::span<const Vector6> held) {
  const Matrix6 scale = equations.unscale.inverse();
  Matrix6 others = Matrix6::Identity();
  for (const Vector6& motion : held) {
    Vector6 about_centre = motion;
    about_centre.head<3>() += motion.tail<3>().cross(equations.centre_m);
    const Vector6 direction = others * (scale * about_centre);  // what the ones before have not held already
    if (direction.squaredNorm() > 0.0) others -= direction * direction.transpose() / direction.squaredNorm();
  }
  if (!(equations.weight > 0.0)) return nothing_fixed();
  ObservableSplit split;
  // What is held has no information left, and comes first.
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(others * equations.information * others / equations.weight);
  split.shares = solver.eigenvalues();
  split.directions = solver.eigenvectors();
  while (split.unobservable < 6 && split.shares[split.unobservable] < kNothing) ++split.unobservable;
  return split;
}

Vector6 motion_of_frame(const NormalEquations& equations, const Vector6& direction) {
  Vector6 motion = equations.unscale * direction;
  motion.head<3>() -= motion.tail<3>().cross(equations.centre_m);
  return motion;
}

Vector6 fixed_part(const NormalEquations& equations, const ObservableSplit& split, const Vector6& motion) {
  const auto fixed = split.directions.rightCols(6 - split.unobservable);
  const Vector6 scaled = equations.unscale.inverse() * motion;
  return equations.unscale * (fixed * (fixed.transpose() * scaled));
}

Vector6 solve_observable(const NormalEquations& equations, const ObservableSplit& split) {
  return -(equations.unscale * (observable_inverse(equations, split) * equations.gradient));
}

Matrix6 patch_covariance(std::span<const PlaneResidual> residuals, const NormalEquations& equations,
                         const ObservableSplit& split, double cell_m, double patch_sigma_m) {
  const std::vector<Patch> patches = patches_of(residuals, equations, cell_m);
  Matrix6 meat = Matrix6::Zero();
  Matrix6 offsets = Matrix6::Zero();
  for (const Patch& patch : patches) {
    meat += patch.gradient * patch.gradient.transpose();
    offsets += patch.pull * patch.pull.transpose();
  }
  const double count = static_cast<double>(patches.size());
  if (count > 6.0) meat *= count / (count - 6.0);  // six unknowns were fitted to these patches
  return solved_covariance(equations, split, meat + patch_sigma_m * patch_sigma_m * offsets);
}

Matrix6 offset_covariance(std::span<const PlaneResidual> residuals, const NormalEquations& equations,
                          const ObservableSplit& split, const PatchOffsets& offsets) {
  Matrix6 meat = Matrix6::Zero();
  for (const Patch& patch : patches_of(residuals, equations, offsets.cell_m)) {
    if (!(patch.weight > 0.0)) continue;
    const double variance_m2 =
        offsets.of_residuals * patch.squares_m2 / patch.weight + offsets.sigma_m * offsets.sigma_m;
    meat += variance_m2 * patch.pull * patch.pull.transpose();
  }
  return solved_covariance(equations, split, meat);
}

Matrix6 cell_covariance(std::span<const PlaneResidual> residuals, const NormalEquations& equations,
                        const ObservableSplit& split, double variance_m2) {
  if (variance_m2 == 0.0) return Matrix6::Zero();
  const Matrix6 along =
      0.5 * (pulls_of(planes_of(residuals, equations, 0.0)) + pulls_of(planes_of(residuals, equations, 0.5)));
  const Matrix6 slanted = pulls_of(surfaces_of(residuals, equations, kSlant_m));
  return solved_covariance(equations, split, variance_m2 * ((1.0 - kSlantShare) * along + kSlantShare * slanted));
}

Matrix6 blur_covariance(const NormalEquations& equations, const ObservableSplit& split) {
  Matrix6 blur = Matrix6::Zero();
  for (int k = split.unobservable; k < 6; ++k) {
    blur += split.blur_m[k] * split.blur_m[k] * split.directions.col(k) * split.directions.col(k).transpose();
  }
  return equations.unscale * blur * equations.unscale.transpose();
}

Matrix6 prior_covariance(const NormalEquations& equations, const ObservableSplit& split, double prior_translation_m,
                         double prior_rotation_rad) {
  if (split.unobservable == 0) return Matrix6::Zero();
  // The prior belongs to (v, w). Of directions that are free together any basis is as good as another.
  const Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 6> free =
      equations.unscale * split.directions.leftCols(split.unobservable);
  Vector6 deviations;
  deviations << Eigen::Vector3d::Constant(prior_translation_m), Eigen::Vector3d::Constant(prior_rotation_rad);
  const auto in_priors = (deviations.cwiseInverse().asDiagonal() * free).eval();
  const auto information = (in_priors.transpose() * in_priors).eval();
  return free * information.ldlt().solve(free.transpose());
}

std::size_t count_below(std::span<const PlaneResidual> residuals, double limit_m) {
  return static_cast<std::size_t>(std::count_if(
      residuals.begin(), residuals.end(), [&](const PlaneResidual& r) { return std::abs(r.residual_m) < limit_m; }));
}

Eigen::Matrix3d scatter_about(std::span<const PlaneResidual> residuals, const Eigen::Vector3d& centre_m) {
  Eigen::Matrix3d scatter_m2 = Eigen::Matrix3d::Zero();
  for (const PlaneResidual& r : residuals) {
    const Eigen::Vector3d arm_m = r.point_m - centre_m;
    scatter_m2.noalias() += arm_m * arm_m.transpose() / static_cast<double>(residuals.size());
  }
  return scatter_m2;
}

Matrix6 covariance_in_source(const Matrix6& about_centre, const Eigen::Vector3d& centre_m,
                             const Pose3& T_target_source) {
  // x -> c + w x (x - c) + v moves the target frame's origin by v - w x c.
  Matrix6 to_origin = Matrix6::Identity();
  to_origin.topRightCorner<3, 3>() = skew(centre_m);
  const Matrix6 to_source = adjoint(T_target_source.inverse()) * to_origin;
  const Matrix6 moved = to_source * about_centre * to_source.transpose();
  return 0.5 * (moved + moved.transpose());
}

Pose3 motion_about(const Eigen::Vector3d& centre_m, const Vector6& step) {
  Vector6 turn = Vector6::Zero();
  turn.tail<3>() = step.tail<3>();
  const Pose3 rotation = Pose3::exp(turn);
  const Eigen::Vector3d translation_m = centre_m + step.head<3>() - rotation.rotation() * centre_m;
  return {rotation.rotation(), translation_m};
}

}  // namespace kilter
