// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/sum_jacobians.h"

#include <array>
#include <cstddef>
#include <cstring>

namespace kilter {
namespace {

JacobianSums sum_baseline(std::span<const PlaneResidual> residuals, const Eigen::Vector3d& centre_m) {
  Matrix6 information = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
  for (const PlaneResidual& r : residuals) {
    const Vector6 j = plain_jacobian(r, centre_m);
    information.noalias() += r.weight * j * j.transpose();
    gradient += r.weight * r.residual_m * j;
  }
  return {information, gradient};
}

#if defined(__x86_64__)
using Lanes = double __attribute__((vector_size(64)));

// A residual as it lies in memory fills one register: x y z of the point, of the direction, residual, weight.
static_assert(offsetof(PlaneResidual, point_m) == 0 && offsetof(PlaneResidual, direction) == 24 &&
              offsetof(PlaneResidual, residual_m) == 48 && offsetof(PlaneResidual, weight) == 56);

// Lanes 6 and 7 hold what nobody asks for.
[[gnu::target("avx512f")]] JacobianSums sum_avx512(std::span<const PlaneResidual> residuals,
                                                   const Eigen::Vector3d& centre_m) {
  const Lanes centre = {centre_m.x(), centre_m.y(), centre_m.z()};
  std::array<Lanes, 6> rows{};
  Lanes gradient{};
  for (const PlaneResidual& r : residuals) {
    Lanes all;
    std::memcpy(&all, static_cast<const void*>(&r), sizeof(all));
    const Lanes arm = all - centre;
    const Lanes cross = __builtin_shufflevector(arm, arm, 0, 0, 0, 1, 2, 0, 0, 0) *
                            __builtin_shufflevector(all, all, 0, 0, 0, 5, 3, 4, 0, 0) -
                        __builtin_shufflevector(arm, arm, 0, 0, 0, 2, 0, 1, 0, 0) *
                            __builtin_shufflevector(all, all, 0, 0, 0, 4, 5, 3, 0, 0);
    const Lanes j = __builtin_shufflevector(all, cross, 3, 4, 5, 11, 12, 13, 3, 3);
    const Lanes weighted = r.weight * j;
    rows[0] += __builtin_shufflevector(weighted, weighted, 0, 0, 0, 0, 0, 0, 0, 0) * j;
    rows[1] += __builtin_shufflevector(weighted, weighted, 1, 1, 1, 1, 1, 1, 1, 1) * j;
    rows[2] += __builtin_shufflevector(weighted, weighted, 2, 2, 2, 2, 2, 2, 2, 2) * j;
    rows[3] += __builtin_shufflevector(weighted, weighted, 3, 3, 3, 3, 3, 3, 3, 3) * j;
    rows[4] += __builtin_shufflevector(weighted, weighted, 4, 4, 4, 4, 4, 4, 4, 4) * j;
    rows[5] += __builtin_shufflevector(weighted, weighted, 5, 5, 5, 5, 5, 5, 5, 5) * j;
    gradient += r.weight * r.residual_m * j;
  }
  JacobianSums sums;
  for (int a = 0; a < 6; ++a) {
    for (int b = 0; b < 6; ++b) sums.information(a, b) = rows[static_cast<std::size_t>(a)][b];
    sums.gradient[a] = gradient[a];
  }
  return sums;
}
#endif

}  // namespace

SumJacobians sum_jacobians_with(VectorPath path) {
#if defined(__x86_64__)
  if (path == VectorPath::kAvx512) return sum_avx512;
#else
  static_cast<void>(path);
#endif
  return sum_baseline;
}

}  // namespace kilter
