// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <vector>

#include "kilter/base/vector_path.h"
#include "kilter/occupancy/scan_marks.h"

namespace kilter {

/// Where the rays of one scan end, as three columns of which the first `count` entries are meant, with room behind them
/// so that whole registers can be read from any of these. Map's frame. [m]
struct RayEnds {
  std::vector<float> x, y, z;

  /// Makes room for so many, so that add() need not look.
  void clear_for(std::size_t most);
  void add(const Eigen::Vector3f& end_m) {
    x[count] = end_m.x();
    y[count] = end_m.y();
    z[count] = end_m.z();
    ++count;
  }

  [[nodiscard]] Eigen::Vector3f operator[](std::size_t i) const { return {x[i], y[i], z[i]}; }

  std::size_t count = 0;
};

/// Length of a vector in the order and precision of OctoMap: squares and their sum are floats, the root is a double.
[[nodiscard]] inline double ray_length_m(const Eigen::Vector3f& v) {
  return std::sqrt(static_cast<double>(v.x() * v.x() + v.y() * v.y() + v.z() * v.z()));
}

/// What scans are made of. Whatever the path, the same voxels are marked. Every ray must lie in the marks' window, a
/// block from its border.
struct RayKernels {
  /// Marks, for each ray from `origin_m`, every voxel from the origin's up to, not including, that of the ray's end as
  /// kMiss: Amanatides and Woo's traversal as OctoMap's computeRayKeys has it, with its rounding. Where rounding leads
  /// a ray past its last voxel, its length ends it.
  void (*trace)(const Eigen::Vector3f& origin_m, const RayEnds& ends_m, double resolution_m, ScanMarks& marks);
  /// Marks the voxels of the first `count` ends as kHit.
  void (*mark_hits)(const RayEnds& ends_m, std::size_t count, double resolution_m, ScanMarks& marks);
};

/// For dense windows.
[[nodiscard]] RayKernels ray_kernels(VectorPath path);

/// One ray after the other, for any window; slower.
[[nodiscard]] RayKernels ray_kernels_one_by_one();

}  // namespace kilter
