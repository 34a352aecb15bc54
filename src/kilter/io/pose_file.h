// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>

#include "kilter/base/expected.h"
#include "kilter/io/pose_list.h"

namespace kilter {

/// A trajectory of a million poses has some 100 MB.
inline constexpr std::uint64_t kMaxPoseFileBytes = std::uint64_t{1} << 30;

/// The one file `poses.*` of a folder. \return its path, or kNotFound, kUnsupported (several), kIo.
[[nodiscard]] Expected<std::filesystem::path> find_pose_file(const std::filesystem::path& folder);

/// Reads a whole file of poses. \return what read_pose_list gives, or what read_file fails with.
[[nodiscard]] Expected<PoseList> read_pose_file(const std::filesystem::path& path);

}  // namespace kilter
