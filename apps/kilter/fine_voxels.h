// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "kilter/occupancy/occupancy_options.h"
#include "kilter/pipeline/check.h"

namespace kilter::app {

/// What a person should know before any work where voxels are so fine that it takes ten times as long as usual, or
/// more.
[[nodiscard]] std::optional<std::string> note_on_fine_voxels(const OccupancyOptions& options);

/// The same where the tolerance is far below what voxels of that edge tell, so that pairs stay unverified whose offset
/// is larger. Nothing for the paper's test, which knows no tolerance.
[[nodiscard]] std::optional<std::string> note_on_fine_tolerance(const CheckOptions& options);

}  // namespace kilter::app
