// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "kilter/base/expected.h"
#include "kilter/geometry/point_cloud.h"
#include "kilter/submap/robot_log.h"

namespace kilter {

/// Files of points that kilter reads; the extension decides, in any case of letters.
enum class CloudFormat { kBin, kPcd, kPly, kLas };

/// The format that a file's name promises; nothing for other names.
[[nodiscard]] std::optional<CloudFormat> cloud_format_of(std::string_view file_name);

/// Reads one cloud, in the file's own frame. [m]
///
/// A file may hold no point, or only points that are dropped and counted: whether that is an error is the caller's to
/// say. \return the points, or kUnsupported (extension, size) or what read_file and the format's reader fail with.
[[nodiscard]] Expected<PointCloud> read_cloud_file(const std::filesystem::path& path);

/// Looks at a cloud's size and first bytes only. \return nothing if it cannot be opened; no count of points where the
/// header does not tell or is broken. What is cut short may be told too late (CloudPeek::is_cut_short), never wrongly.
[[nodiscard]] std::optional<CloudPeek> peek_cloud_file(const std::filesystem::path& path);

}  // namespace kilter
