// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <cstdio>

#include "kilter/geometry/pose3.h"

// A single module brings what it needs itself: its headers, its lower floors, Eigen.
int main() {
  const kilter::Pose3 T_world_sensor = kilter::Pose3::from_translation(1.0, 2.0, 3.0);
  const double distance_m = (T_world_sensor * Eigen::Vector3d(0.0, 0.0, 3.0)).norm();
  std::printf("%.6f\n", distance_m);
  return std::abs(distance_m - std::sqrt(41.0)) < 1e-12 ? 0 : 1;
}
