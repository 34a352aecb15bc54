// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/submap/robot_log.h"

namespace kilter {

/// Each robot's submaps as ranges of scans; without gaps, the first range beginning at scan 0.
using Cuts = std::map<std::string, std::vector<ScanRange>>;

/// Takes from the text of a result.json where it cut submaps, so that another run can cut at the same scans.
///
/// Only `schema` and `submaps` are looked at, and only they are held in memory.
/// \param where  the file's name, for messages
/// \return  the cuts; or kParse (not JSON, keys missing, of another type or too deep, ranges with gaps or overlaps),
///          kUnsupported (another schema; finished submaps, which have no scans), kEmptyInput.
[[nodiscard]] Expected<Cuts> parse_cuts(std::string_view json_text, const std::string& where);

/// The same of a file, or of the result.json in an output folder. \return also what read_file fails with.
[[nodiscard]] Expected<Cuts> read_cuts(const std::filesystem::path& result);

/// Numbers of such a result's configuration, in SI units: those of the keys that it holds; none where it cannot be
/// read.
[[nodiscard]] std::map<std::string, double> config_numbers_of_result(const std::filesystem::path& result,
                                                                     std::span<const std::string_view> keys);

/// The folder whose poses (`--poses`) such a result's map was drawn with; absent where it had the mission's own, or
/// where it cannot be read.
[[nodiscard]] std::optional<std::string> poses_of_result(const std::filesystem::path& result);

}  // namespace kilter
