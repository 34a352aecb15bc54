// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "kilter/base/expected.h"
#include "kilter/io/cuts.h"
#include "kilter/io/mission.h"
#include "kilter/pipeline/check.h"

namespace kilter::app {

/// Reads where `--cuts RESULT` cut submaps. Robots of which it knows nothing are cut anew; a note of `mission` then
/// says which. \return what read_cuts fails with; kCountMismatch where it knows none of the robots.
[[nodiscard]] Expected<Cuts> read_cuts_for(Mission& mission, const std::string& result);

/// What check and submaps are told by --cuts and --submap-poses: reads the former, and moves the mission's submaps to
/// where the latter has them. The options take over how the former was cut. \return where to cut, empty without --cuts;
/// or what either fails with. \param poses  what --poses says: a submap is moved with the poses that its scans had
/// inside it. How far submaps moved is told in a note of `mission`
[[nodiscard]] Expected<Cuts> place_submaps(Mission& mission, CheckOptions& options,
                                           const std::optional<std::string>& cuts_result,
                                           const std::optional<std::string>& submap_poses,
                                           const std::optional<std::string>& poses);

}  // namespace kilter::app
