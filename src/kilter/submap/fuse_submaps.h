// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/occupancy/occupancy_cells.h"
#include "kilter/occupancy/occupancy_options.h"
#include "kilter/submap/submap.h"

namespace kilter {

/// One occupied voxel of a fused map.
struct FusedVoxel {
  Eigen::Vector3d centroid_world_m;  ///< mean of the contributing submaps' centroids. [m]
  double log_odds = 0.0;             ///< summed over submaps, clamped
  int robot = 0;                     ///< robot of the first submap (in id order) that put a surface here
};

/// Lends the map of one submap to `use`, for as long as that runs. \return why there is none.
using LendMap = std::function<Expected<void>(SubmapId id, const std::function<void(const VoxelMap&)>& use)>;

/// A robot's local map (Eq. 2) or the global map (Eq. 3): the submaps' voxels on one world lattice, log-odds summed.
/// A submap contributes to a cell the largest log-odds of its voxels whose centroid falls there, or one miss where it
/// knows the cell's centroid to be free. Only cells that end up occupied are returned, sorted by z, y, x.
///
/// \param nodes  in id order.
/// \param lend   asked twice for each of them, one at a time: no two submaps are needed in memory together.
/// \return the voxels, or what `lend` failed with.
/// O(V log V) for V voxels of all submaps; memory: some 200 bytes for each cell that any of them occupies,
/// of which the voxels that are returned keep 40.
[[nodiscard]] Expected<std::vector<FusedVoxel>> fuse_submaps(std::span<const SubmapNode> nodes, const LendMap& lend,
                                                             const OccupancyOptions& options);

/// Fused voxels as cells of level 0 of the same lattice: occupied space alone, nothing of what is free.
/// \return  the cells, or kUnsupported: what lies too far from the world's origin for 16 bits (see cells_from_map).
[[nodiscard]] Expected<OccupancyCells> cells_from_fused(std::span<const FusedVoxel> voxels, double resolution_m);

}  // namespace kilter
