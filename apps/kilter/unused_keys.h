// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "kilter/io/mission.h"
#include "kilter/pipeline/check.h"

namespace kilter::app {

/// A note where keys that say what becomes of scans have another value than usual, and robots of the mission come as
/// finished submaps, which nothing cuts and whose points have no range.
[[nodiscard]] std::optional<std::string> note_on_unused_keys(const Mission& mission, const CheckOptions& options);

}  // namespace kilter::app
