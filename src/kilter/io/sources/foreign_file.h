// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kilter/io/sources/source_kind.h"

namespace kilter {

/// Whether a file's name is that of a format that people bring, kilter does not read, and something else converts.
[[nodiscard]] bool is_foreign_file(const std::filesystem::path& path);

/// \return  always kUnsupported: what the file is, and what to convert it with.
[[nodiscard]] Expected<RobotLog> refuse_foreign_file(const SourceRequest& request, std::vector<std::string>& notes);

}  // namespace kilter
