// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/submap/submap.h"

namespace kilter {

Eigen::AlignedBox3d Submap::bounds_world_m() const {
  Eigen::AlignedBox3d box;
  if (map.bounds_m().isEmpty()) return box;
  for (int corner = 0; corner < 8; ++corner) {
    box.extend(T_world_submap * map.bounds_m().corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)));
  }
  return box;
}

}  // namespace kilter
