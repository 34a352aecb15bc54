// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/bend.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

namespace kilter {
namespace {

constexpr std::size_t kFewestOfGroup = 20;

double median_of(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

Bend measure_bend(std::span<const PlaneResidual> residuals, double cell_m) {
  std::map<std::array<int, 4>, std::vector<double>> groups;
  for (const PlaneResidual& r : residuals) {
    int axis = 0;
    r.direction.cwiseAbs().maxCoeff(&axis);
    const Eigen::Vector3i cell = (r.point_m / cell_m).array().floor().matrix().cast<int>();
    // The displacement of the source along the positive axis, whichever side the surface was seen from.
    groups[{axis, cell.z(), cell.y(), cell.x()}].push_back(r.direction[axis] < 0.0 ? -r.residual_m : r.residual_m);
  }
  Bend bend;
  std::array<double, 3> squares{};
  std::array<double, 3> counts{};
  for (auto& [key, values] : groups) {
    if (values.size() < kFewestOfGroup) continue;
    const auto axis = static_cast<std::size_t>(key[0]);
    const double count = static_cast<double>(values.size());
    const double median_m = median_of(values);
    for (double& value : values) value = std::abs(value - median_m);
    // Surfaces that moved as one have residuals of one size; clutter has all sizes, and says nothing.
    const double apart_m = std::max(std::abs(median_m) - median_of(values), 0.0);
    squares[axis] += count * apart_m * apart_m;
    counts[axis] += count;
    ++bend.groups;
  }
  double total_m2 = 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (counts[axis] > 0.0) total_m2 += squares[axis] / counts[axis];
  }
  bend.rms_m = std::sqrt(total_m2);
  return bend;
}

}  // namespace kilter
