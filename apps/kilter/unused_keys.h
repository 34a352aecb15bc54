// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kilter/io/mission.h"
#include "kilter/pipeline/check.h"

namespace kilter::app {

/// A note where keys that say what becomes of scans have another value than usual, and robots of the mission come as
/// finished submaps, which nothing cuts and whose points have no range.
[[nodiscard]] std::optional<std::string> note_on_unused_keys(const Mission& mission, const CheckOptions& options);

/// A note for each of the usual methods that the paper's take the place of (OICP, its test of Gamma), where keys of it
/// have another value than usual.
[[nodiscard]] std::vector<std::string> notes_on_keys_of_other_methods(const CheckOptions& options);

/// Takes over the keys by which a result cut its submaps, so that what is cut anew is cut alike, and the configuration
/// says what submaps were cut by. \return a note where they had been set to something else.
[[nodiscard]] std::optional<std::string> take_keys_of_cuts(const std::string& cuts_result, CheckOptions& options);

}  // namespace kilter::app
