// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/io/mission.h"

namespace kilter::app {

/// Whether results may go to `folder` under `names`: a folder of clouds that got others beside them could not be read
/// again, and a cloud that `sources` name itself must not become a result.
/// \param sources  of the command line, which `mission` was opened from
/// \return  kUsage.
[[nodiscard]] Expected<void> check_apart_from_clouds(const std::filesystem::path& folder,
                                                     const std::vector<std::filesystem::path>& names,
                                                     const std::vector<std::string>& sources, const Mission& mission);

}  // namespace kilter::app
