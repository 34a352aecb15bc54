// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/submap/submap.h"

namespace kilter {

Eigen::AlignedBox3d moved_box(const Eigen::AlignedBox3d& box_m, const Pose3& T) {
  Eigen::AlignedBox3d moved_m;
  if (box_m.isEmpty()) return moved_m;
  for (int corner = 0; corner < 8; ++corner) {
    moved_m.extend(T * box_m.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)));
  }
  return moved_m;
}

}  // namespace kilter
