// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "kilter/base/expected.h"

namespace kilter::app {

/// A file of the output folder.
struct OutputFile {
  std::filesystem::path name;  ///< relative, at most one folder deep
  std::string bytes;
};

/// Whether files of these names could be written to `folder`, found out before hours of work: it is a folder or can be
/// made (what is made to find out goes again), it takes names of that length, and no folder has the name of a file, nor
/// anything else that of a folder inside it, nor has what a sticky folder lets only another user replace.
/// \return kIo, kNoSpace.
[[nodiscard]] Expected<void> probe_output_folder(const std::filesystem::path& folder,
                                                 const std::vector<std::filesystem::path>& names = {});

/// Whether one file may be written under a name from the command line: it ends in `extension` (".ply"), and none of the
/// run's `inputs` stands there. \return kUsage.
[[nodiscard]] Expected<void> check_output_file(const std::filesystem::path& file, std::string_view extension,
                                               const std::vector<std::filesystem::path>& inputs);

/// Whether a file of that name could be written into a folder that is there, before any work.
/// \return kNotFound, kIo.
[[nodiscard]] Expected<void> probe_output_file(const std::filesystem::path& file);

/// Makes the folder where it is missing and writes the files: all of them first, then each is renamed, in the order
/// given, so that no reader finds half of one. A full disk changes nothing, nor does a rename that is refused, be it
/// the last. Files of others stay; a symlink in the place of a file is replaced, one in the place of a folder inside
/// `folder` is refused. A stop that is asked for before the first is renamed changes nothing either. \return kIo,
/// kNoSpace, kCancelled.
[[nodiscard]] Expected<void> write_output_folder(const std::filesystem::path& folder,
                                                 const std::vector<OutputFile>& files);

}  // namespace kilter::app
