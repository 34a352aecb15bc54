// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace kilter {

/// Points of one scan or submap in that scan's or submap's own frame, and what was left out while reading.
struct PointCloud {
  std::vector<Eigen::Vector3f> points_m;  ///< finite, each coordinate below kMaxCoordinate_m
  std::size_t dropped_nonfinite = 0;      ///< NaN or Inf in the file
  std::size_t dropped_far = 0;            ///< finite, but beyond any lidar: |coordinate| > kMaxCoordinate_m

  static constexpr float kMaxCoordinate_m = 10000.0F;

  /// Adds the point, or counts why not.
  void add(float x, float y, float z) {
    const Eigen::Vector3f point(x, y, z);
    if (!point.allFinite()) {
      ++dropped_nonfinite;
    } else if (point.cwiseAbs().maxCoeff() > kMaxCoordinate_m) {
      ++dropped_far;
    } else {
      points_m.push_back(point);
    }
  }
};

}  // namespace kilter
