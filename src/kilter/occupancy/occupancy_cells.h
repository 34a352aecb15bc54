// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/occupancy/occupancy_options.h"
#include "kilter/occupancy/voxel_map.h"

namespace kilter {

/// A cube of one occupancy: a leaf of an octree. Covers 2^level cells an axis, from `index` on.
struct OccupancyCell {
  std::array<std::int16_t, 3> index{};  ///< x, y, z of its lowest cell
  std::uint8_t level = 0;               ///< 0 = one cell .. 16 = all there is
  float log_odds = 0.0F;                ///< of being occupied
};

/// Known space as OctoMap keeps it: cubes that do not overlap, on a lattice with a corner at the frame's origin, so
/// that cell i covers [i r, (i + 1) r). 16 bits an axis. What no cell covers is unknown.
struct OccupancyCells {
  double resolution_m = 0.1;  ///< edge of a cube of level 0; > 0. [m]
  std::vector<OccupancyCell> cells;

  /// What has this log-odds or more is occupied, as far as OctoMap's files go: a probability of one half.
  static constexpr float kOccupiedFrom = 0.0F;
};

/// Known space as a map at `options.resolution_m`, with normals that point to the free side of each surface.
///
/// A voxel gets the largest log-odds of the cells that hold its centre and of the smaller ones whose centre it holds:
/// at equal resolution it is its cell, exactly; a larger cell is all the voxels inside; of several smaller ones the
/// most occupied counts. It is occupied from `options.occupancy_threshold` on, free below that and
/// below one half, and unknown in between. Centroids are centres, good to a cell: VoxelMap::cell_m is the edge of the
/// smallest occupied cell, or of a voxel if that is larger.
///
/// \return  the map; or kUnsupported: a cell beyond the lattice, or n cells that fill over 2^19 + 8 n blocks of 8^3
///          voxels (2^19 are 268,000 m^3 at 0.1 m) or hold over 2^18 + 512 n occupied voxels.
/// O(V) for V voxels that are filled, about 1 us for each occupied one.
[[nodiscard]] Expected<VoxelMap> map_from_cells(const OccupancyCells& known, const OccupancyOptions& options);

/// A map's voxels as cells of level 0, in block order. A map keeps no probability of what is free.
///
/// \param free_log_odds  what free voxels get; < 0
/// \return  the cells, or kUnsupported: a voxel's index does not fit into 16 bits (3276.8 m at 0.1 m).
[[nodiscard]] Expected<OccupancyCells> cells_from_map(const VoxelMap& map, float free_log_odds);

/// Shorthand for the second: lattice coordinates as a cell of level 0. \return kUnsupported as above.
[[nodiscard]] Expected<OccupancyCell> cell_of_voxel(const VoxelIndex& voxel, double resolution_m, float log_odds);

}  // namespace kilter
