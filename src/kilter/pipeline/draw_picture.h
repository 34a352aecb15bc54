// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "kilter/base/expected.h"
#include "kilter/base/parallel.h"
#include "kilter/pipeline/picture.h"
#include "kilter/pipeline/result.h"
#include "kilter/pipeline/submap_store.h"
#include "kilter/submap/robot_log.h"
#include "kilter/submap/submap.h"

namespace kilter {

/// Takes from the submaps what is worth seeing of a finished result. Memory is bounded by max_points: at most that
/// many points, and twice as many samples over all pairs. Same bits for any number of threads.
///
/// \param nodes   the submaps whose maps `store` has.
/// \param result  with robots, submaps and pairs filled in.
/// \return what the store failed with.
[[nodiscard]] Expected<Picture> draw_picture(std::span<const RobotLog> robots, std::span<const SubmapNode> nodes,
                                             SubmapStore& store, const Result& result, const PictureOptions& options,
                                             const RunContext& run);

}  // namespace kilter
