// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "kilter/pipeline/result.h"

namespace kilter {

/// A fused map (Eq. 2-3) as a binary little-endian PLY: a vertex per occupied voxel with double x y z (world frame, as
/// far from the origin as it is) [m], uchar red green blue by robot, float probability of being occupied. Comments name
/// map, frame and each robot's colour.
///
/// \param robots  of the same result, in its order.
[[nodiscard]] std::string map_ply(const FusedMap& map, const std::vector<RobotSummary>& robots);

}  // namespace kilter
