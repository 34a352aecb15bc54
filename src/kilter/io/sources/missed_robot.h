// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "kilter/base/expected.h"

namespace kilter {

/// Whether a folder of no known kind may be passed over: it can be read, and nothing in it is called scans, submaps (in
/// any case of letters) or poses.*. Anything else is a robot that must not be left out silently.
/// \return  kIo (no permission, a file called scans), kNotFound (a link to nothing, poses without clouds), or what
///          list_clouds_of fails with.
[[nodiscard]] Expected<void> check_holds_no_robot(const std::filesystem::path& folder);

}  // namespace kilter
