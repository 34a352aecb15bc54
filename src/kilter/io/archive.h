// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "kilter/base/expected.h"
#include "kilter/pipeline/picture.h"

namespace kilter {

/// What the report is drawn from: `result.kilter`.
struct Archive {
  std::string json;  ///< result.json without `run`
  Picture picture;
};

/// The bytes of result.kilter; docs/archive.md describes them. Equal archives give equal bytes.
[[nodiscard]] std::string archive_bytes(const Archive& archive);

/// Reads them back. Made for files that lie: nothing is allocated that the bytes left do not hold, every count is
/// checked against them and against each other.
/// \param where  the file's name, for messages
/// \return  kParse (no archive, or one whose parts do not fit), kUnsupported (of a later kilter), kTruncated.
[[nodiscard]] Expected<Archive> parse_archive(std::string_view bytes, const std::string& where);

/// The bytes of an archive that parse_archive accepts: a file, or the result.kilter in an output folder.
/// \return  also what read_file fails with.
[[nodiscard]] Expected<std::string> read_archive_bytes(const std::filesystem::path& result);

}  // namespace kilter
