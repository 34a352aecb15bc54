// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

#include "kilter/base/vector_path.h"
#include "kilter/registration/normal_equations.h"

namespace kilter {

/// d residual / d (v, w) about the centre, target axes.
[[nodiscard]] inline Vector6 plain_jacobian(const PlaneResidual& r, const Eigen::Vector3d& centre_m) {
  Vector6 j;
  j.head<3>() = r.direction;
  j.tail<3>() = (r.point_m - centre_m).cross(r.direction);
  return j;
}

/// By how much a small motion (v, w) about the centre changes a residual: J (v, w), to the bit what Eigen makes of it
/// on registers of two doubles, but from scalars, since a vector that was written piece by piece is waited for.
[[nodiscard]] inline double change_of_residual(const PlaneResidual& r, const Eigen::Vector3d& centre_m,
                                               const Vector6& motion) {
  const double x_m = r.point_m.x() - centre_m.x();
  const double y_m = r.point_m.y() - centre_m.y();
  const double z_m = r.point_m.z() - centre_m.z();
  const double about_x = y_m * r.direction.z() - z_m * r.direction.y();
  const double about_y = z_m * r.direction.x() - x_m * r.direction.z();
  const double about_z = x_m * r.direction.y() - y_m * r.direction.x();
  return (r.direction.x() * motion[0] + (r.direction.z() * motion[2] + about_y * motion[4])) +
         (r.direction.y() * motion[1] + (about_x * motion[3] + about_z * motion[5]));
}

/// Over all residuals, with J the plain Jacobian.
struct JacobianSums {
  Matrix6 information = Matrix6::Zero();  ///< sum w J J^T
  Vector6 gradient = Vector6::Zero();     ///< sum w r J
};

using SumJacobians = JacobianSums (*)(std::span<const PlaneResidual> residuals, const Eigen::Vector3d& centre_m);

/// All of them add in the same order and precision, so that the answer is the same to the bit. What registration spends
/// most arithmetic on.
[[nodiscard]] SumJacobians sum_jacobians_with(VectorPath path);

}  // namespace kilter
