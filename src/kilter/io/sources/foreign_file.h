// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "kilter/io/sources/source_kind.h"

namespace kilter {

/// A format that people bring, kilter does not read, and something else converts.
struct ForeignFormat {
  std::string_view extension;
  std::string_view what;     ///< "compressed LAS"
  std::string_view way_out;  ///< what converts it
};

/// The format of the first of some files' names that is in one; nullptr if none is.
[[nodiscard]] const ForeignFormat* find_foreign(std::span<const std::string> names);

/// What converts the first of some files that needs it; empty if none does.
[[nodiscard]] std::string way_out_of_foreign(std::span<const std::string> names);

/// Whether a file's name is that of a format that people bring, kilter does not read, and something else converts.
[[nodiscard]] bool is_foreign_file(const std::filesystem::path& path);

/// \return  always kUnsupported: what the file is, and what to convert it with.
[[nodiscard]] Expected<RobotLog> refuse_foreign_file(const SourceRequest& request, std::vector<std::string>& notes);

}  // namespace kilter
