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
