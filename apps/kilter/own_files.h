// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "kilter/base/expected.h"

namespace kilter::app {

/// What the head of a report holds: that of a kilter with its viewer, or without.
inline constexpr std::array<std::string_view, 2> kMarksOfReport = {
    "<title>kilter: where the map is wrong</title>", "<title>kilter</title></head>\n<body><h1>No report here</h1>"};

/// Whether a run may put its file where `file` says: nothing stands there, or a symlink (it is replaced, not followed),
/// an empty file, or one that an earlier run wrote, by one of `marks` in its first 4 KiB. \return kUsage.
[[nodiscard]] Expected<void> check_replaceable(const std::filesystem::path& file,
                                               std::span<const std::string_view> marks);

/// The same for the files of `check`: those in `folder` are ours where its result.kilter is, its result.json or its
/// report.html; result.json itself where it names our schema; those in maps/ where the map.ply is ours.
/// \return kUsage with the first that is not.
[[nodiscard]] Expected<void> check_results_replaceable(const std::filesystem::path& folder,
                                                       const std::vector<std::filesystem::path>& names);

}  // namespace kilter::app
