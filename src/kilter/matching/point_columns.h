// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>

namespace kilter {

/// Three coordinates of each element of one batch, a column for each, so that loops over them become wide registers.
template <typename Scalar>
struct Columns {
  static constexpr std::size_t kMost = 64;

  alignas(64) std::array<Scalar, kMost> x{};
  alignas(64) std::array<Scalar, kMost> y{};
  alignas(64) std::array<Scalar, kMost> z{};

  void set(std::size_t k, const Eigen::Matrix<Scalar, 3, 1>& value) {
    x[k] = value.x();
    y[k] = value.y();
    z[k] = value.z();
  }
  [[nodiscard]] Eigen::Matrix<Scalar, 3, 1> operator[](std::size_t k) const { return {x[k], y[k], z[k]}; }
};

/// Points of one batch. [m]
using PointColumns = Columns<double>;
/// Centroids or normals of one batch, as maps hold them.
using FloatColumns = Columns<float>;

}  // namespace kilter
