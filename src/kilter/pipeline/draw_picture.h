// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "kilter/base/parallel.h"
#include "kilter/pipeline/measure_pair.h"
#include "kilter/pipeline/picture.h"
#include "kilter/pipeline/result.h"
#include "kilter/submap/robot_log.h"
#include "kilter/submap/submap.h"

namespace kilter {

/// Takes from the submaps what is worth seeing of a finished result. Memory is bounded by max_points: at most that
/// many points, and twice as many samples over all pairs. Same bits for any number of threads.
///
/// \param searches  of the same submaps, in their order.
/// \param result    with robots, submaps and pairs filled in.
[[nodiscard]] Picture draw_picture(std::span<const RobotLog> robots, std::span<const Submap> submaps,
                                   const SubmapSearches& searches, const Result& result, const PictureOptions& options,
                                   const RunContext& run);

}  // namespace kilter
