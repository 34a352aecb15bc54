// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "kilter/base/expected.h"
#include "kilter/io/cuts.h"
#include "kilter/io/mission.h"

namespace kilter::app {

/// Reads where `--cuts RESULT` cut submaps. Robots of which it knows nothing are cut anew; a note of `mission` then
/// says which. \return what read_cuts fails with; kCountMismatch where it knows none of the robots.
[[nodiscard]] Expected<Cuts> read_cuts_for(Mission& mission, const std::string& result);

}  // namespace kilter::app
