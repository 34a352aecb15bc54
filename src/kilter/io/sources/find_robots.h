// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/io/sources/source_kind.h"

namespace kilter {

/// A robot's place on disk, named and recognised, not opened.
struct FoundRobot {
  std::string name;
  std::filesystem::path path;
  const SourceKind* kind = nullptr;
  std::vector<std::string> topics;
  std::vector<std::string> links;  ///< beside it, which lead to it and are no robots of their own
  std::size_t source = 0;          ///< which one of the command line named it
  /// Dumps of other programs in the folder that it was found in, which are left out for it. At a source's first robot.
  std::vector<std::string> left_out;
};

/// "kilter reads a folder with poses.* and ...": everything that can be named.
[[nodiscard]] std::string known_kinds();

/// The robots that command-line sources name, as open_mission describes them, sorted bytewise by name.
/// \return  or kUsage (a name given twice, a bad NAME, a topic of what is no bag), kNotFound, kEmptyInput (no robot in
/// a
///          folder), kUnsupported (a file of no known kind, clouds that have to be converted, a folder's name that
///          cannot be a robot's), kIo. The hint tells what of a folder could have been named instead.
[[nodiscard]] Expected<std::vector<FoundRobot>> find_robots(const std::vector<std::string>& sources);

}  // namespace kilter
