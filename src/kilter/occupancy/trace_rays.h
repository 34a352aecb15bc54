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

/// Where the rays of one scan end, as three columns of which the first `count` entries are meant. Map's frame. [m]
struct RayEnds {
  std::vector<float> x, y, z;

  /// Makes room for so many more, so that add() need not look.
  void clear_for(std::size_t most);
  void add(const Eigen::Vector3f& end_m) {
    x[count] = end_m.x();
    y[count] = end_m.y();
    z[count] = end_m.z();
    ++count;
  }

  std::size_t count = 0;
};

/// Length of a vector in the order and precision of OctoMap: squares and their sum are floats, the root is a double.
[[nodiscard]] inline double ray_length_m(const Eigen::Vector3f& v) {
  return std::sqrt(static_cast<double>(v.x() * v.x() + v.y() * v.y() + v.z() * v.z()));
}

/// Marks, for each ray from `origin_m`, every voxel from the origin's up to, not including, that of the ray's end as
/// kMiss: Amanatides and Woo's traversal as OctoMap's computeRayKeys has it, with its rounding. Where rounding leads a
/// ray past its last voxel, its length ends it. Every ray must lie in the marks' window, a block from its border.
using TraceRays = void (*)(const Eigen::Vector3f& origin_m, const RayEnds& ends_m, double resolution_m,
                           ScanMarks& marks);

/// For dense windows. Whatever the path, the same voxels are marked.
[[nodiscard]] TraceRays trace_rays_with(VectorPath path);

/// One ray after the other, for any window; slower.
void trace_rays_one_by_one(const Eigen::Vector3f& origin_m, const RayEnds& ends_m, double resolution_m,
                           ScanMarks& marks);

}  // namespace kilter
