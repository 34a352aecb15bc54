// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "kilter/pipeline/result.h"

namespace kilter {

/// The points of a result's picture as a binary little-endian PLY in the world frame, for CloudCompare and its like:
/// double x y z [m], uchar red green blue by misalignment as in the report, int robot and submap (from 0, in the
/// result's order; comments name them), float misalignment [m], -1 where no pair whose registration is believed saw the
/// point.
///
/// \param tolerance_m  that colours are scaled by. Precondition: the result has its picture.
[[nodiscard]] std::string coloured_ply(const Result& result, double tolerance_m);

}  // namespace kilter
