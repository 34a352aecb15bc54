// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>

namespace kilter {

/// Points of one batch, a column for each coordinate, so that loops over them become wide registers. [m]
struct PointColumns {
  static constexpr std::size_t kMost = 64;

  alignas(64) std::array<double, kMost> x{};
  alignas(64) std::array<double, kMost> y{};
  alignas(64) std::array<double, kMost> z{};

  void set(std::size_t k, const Eigen::Vector3d& point_m) {
    x[k] = point_m.x();
    y[k] = point_m.y();
    z[k] = point_m.z();
  }
  [[nodiscard]] Eigen::Vector3d operator[](std::size_t k) const { return {x[k], y[k], z[k]}; }
};

}  // namespace kilter
