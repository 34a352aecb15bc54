// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>

#include "kilter/pipeline/spill_space.h"

namespace kilter {

/// Where a program's large temporary files belong: what TMPDIR names; else /var/tmp, for /tmp is often kept in memory,
/// and memory is what is short; else what the system says.
[[nodiscard]] std::filesystem::path folder_for_large_temporary_files();

/// Spill space in a file without a name: made when the first bytes come, and gone with this object, or with the process
/// however it ends. Where it cannot be made, the first write says so.
[[nodiscard]] std::unique_ptr<SpillSpace> temporary_file_in(std::filesystem::path folder);

}  // namespace kilter
