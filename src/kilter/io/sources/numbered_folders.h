// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "kilter/base/expected.h"

namespace kilter {

/// Folders in `folder` whose names are six or more digits, as "000012", with a file `inside` in each; by number.
/// \return  their names; may be none. Or what list_folder fails with.
[[nodiscard]] Expected<std::vector<std::string>> list_numbered_folders(const std::filesystem::path& folder,
                                                                       std::string_view inside);

/// Text before a file's points is small; more is refused. A submap of 10'000 frames has some 6 MB.
inline constexpr std::uint64_t kMaxDataTextBytes = std::uint64_t{1} << 26;

/// The first bytes of a file, to be recognised by; nothing if there is no such file.
[[nodiscard]] std::string first_bytes(const std::filesystem::path& file, std::size_t count = 4096);

}  // namespace kilter
