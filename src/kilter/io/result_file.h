// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string_view>

#include "kilter/base/expected.h"

namespace kilter {

/// A file of an earlier result, named by itself or by the output folder of `kilter check` that holds it.
/// \param name   what it is called in an output folder: "result.json"
/// \param takes  what may be named instead; the hint where nothing of the kind is there
/// \return  kNotFound (nothing of that name, or a folder without the file), or what else keeps it from being looked at.
[[nodiscard]] Expected<std::filesystem::path> find_result_file(const std::filesystem::path& result,
                                                               std::string_view name, std::string_view takes);

}  // namespace kilter
