// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <system_error>

namespace kilter_testing {

/// The folder of recorded missions, which is never part of the repository: $KILTER_DATA, or shared/data beside the
/// source tree. Nothing where there is none; such tests skip.
inline std::optional<std::filesystem::path> real_data() {
  const char* named = std::getenv("KILTER_DATA");
  const char* source = std::getenv("KILTER_SOURCE_DIR");  // ctest sets it
  if (named == nullptr && source == nullptr) return std::nullopt;
  const std::filesystem::path folder =
      named != nullptr ? named : std::filesystem::path(source) / ".." / "shared" / "data";
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) return std::nullopt;
  return folder;
}

}  // namespace kilter_testing
