// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kilter/io/sources/source_kind.h"

namespace kilter {

/// Whether a file is a cloud by its name. A .bin file may be anything, so it is not taken for one.
[[nodiscard]] bool is_single_cloud(const std::filesystem::path& file);

/// A whole map in one file: one finished submap in the world's frame, at the identity pose. Two of them compare two
/// sessions' maps: `kilter check a=first.pcd b=second.pcd`. Never fails; the file is read later.
[[nodiscard]] Expected<RobotLog> open_single_cloud(const SourceRequest& request, std::vector<std::string>& notes);

}  // namespace kilter
