// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/io/pose_table.h"

namespace kilter {

/// Counts of clouds and poses that differ: says both, which is the first missing one, and what to take away where that
/// can be told: poses of scans whose numbers are missing, or clouds where the stamps of poses have their largest gap.
/// \param files  names of the clouds, in order
[[nodiscard]] tl::unexpected<Error> refuse_counts(const std::vector<std::string>& files, const PoseTable& poses,
                                                  const std::filesystem::path& pose_file,
                                                  const std::filesystem::path& clouds);

}  // namespace kilter
