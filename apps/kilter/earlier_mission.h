// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "kilter/base/expected.h"

namespace kilter {

/// The schema of truth/faults.json, by which a mission of `simulate` is known.
inline constexpr const char* kFaultsSchema = "kilter.faults/1";

/// Whether a mission may be put into `folder` as `mission/` and `truth/`: neither is there, or, with `replace`, both
/// hold nothing but what `simulate` writes, by names and types: robots a to e with no more scans than they have true
/// poses, in one format. \return kUsage with what is in the way, kIo.
[[nodiscard]] Expected<void> check_room_for_mission(const std::filesystem::path& folder, bool replace);

}  // namespace kilter
