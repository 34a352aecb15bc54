// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kilter/base/expected.h"

namespace kilter::app {

/// A file of the output folder.
struct OutputFile {
  std::filesystem::path name;  ///< relative, at most one folder deep
  std::string bytes;
};

/// Whether `folder` could be written to, found out before hours of work and without making anything: it is a folder, or
/// the nearest of its parents that exists is. \return kIo.
[[nodiscard]] Expected<void> probe_output_folder(const std::filesystem::path& folder);

/// Makes the folder where it is missing and writes the files in the order given, each beside its final name and then
/// renamed, so that no reader finds half of one. Files of others stay; a symlink in the place of a file is replaced,
/// one in the place of a folder inside `folder` is refused. \return kIo, kNoSpace; files before the failing one stay.
[[nodiscard]] Expected<void> write_output_folder(const std::filesystem::path& folder,
                                                 const std::vector<OutputFile>& files);

}  // namespace kilter::app
