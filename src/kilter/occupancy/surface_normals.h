// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kilter/occupancy/voxel_map.h"

namespace kilter {

/// Fits a plane to the centroids around every occupied voxel (5 x 5 x 5 voxels, widened to 9 x 9 x 9 where a sparse
/// sensor left fewer than 8 of them) and stores its unit normal and planarity (sqrt(l1) - sqrt(l0)) / sqrt(l2) of the
/// ordered eigenvalues. On entry `normals` holds each voxel's direction of view; normals point that way. Zero where
/// fewer than 5 neighbours or only a line supports the fit. Centroids count to a 256th of a voxel, in whole numbers.
[[nodiscard]] VoxelMap with_surface_normals(const VoxelMap& map);

}  // namespace kilter
