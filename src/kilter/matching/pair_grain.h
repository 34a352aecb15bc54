// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kilter/occupancy/voxel_map.h"

namespace kilter {

/// How finely the surfaces of two maps can be told apart. Where the points of a map are centres of cells, a wall lies
/// up to half a cell from them, all of it alike, and no number of voxels makes that smaller.
struct PairGrain {
  double edge_m = 0.1;           ///< of a voxel, or of the larger map's cells if they are larger
  double cell_m = 0.0;           ///< of the larger cells; 0 where the points of both are means of hits
  double variance_m2 = 0.0;      ///< of the distance between what both show of one surface, by their cells alone. [m^2]
  double most_m = 0.0;           ///< and that is never larger than this: half a cell of each
  double voxels_per_cell = 1.0;  ///< one measurement, however many voxels it fills

  /// Standard deviation that the cells alone give a distance between two surfaces. [m]
  [[nodiscard]] double sigma_m() const;
};

/// Precondition: both of one resolution.
[[nodiscard]] PairGrain grain_of(const VoxelMap& source, const VoxelMap& target);

}  // namespace kilter
