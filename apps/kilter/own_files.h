// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "kilter/base/expected.h"

namespace kilter::app {

/// Whether a run may put its file where `file` says: nothing stands there, or a symlink (it is replaced, not followed),
/// an empty file, or one that an earlier run wrote, by `mark` in its first 4 KiB. \return kUsage.
[[nodiscard]] Expected<void> check_replaceable(const std::filesystem::path& file, std::string_view mark);

/// The same for the files of `check`: those in `folder` are ours where its result.json is, or its result.kilter where
/// there is no result.json; those in maps/ where the map.ply is. \return kUsage with the first that is not.
[[nodiscard]] Expected<void> check_results_replaceable(const std::filesystem::path& folder,
                                                       const std::vector<std::filesystem::path>& names);

}  // namespace kilter::app
