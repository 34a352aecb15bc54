// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/occupancy/occupancy_options.h"
#include "kilter/submap/submap.h"

namespace kilter::app {

/// How a submap is kept: with free space and probabilities, with free space alone, or as points.
enum class SubmapFormat { kOt, kBt, kPcd, kPly };

[[nodiscard]] std::string extension_of(SubmapFormat format);

/// One submap in its own frame. Free voxels of an octree get the log-odds of one miss; points are voxels' centroids.
/// \return  the file's bytes, or kUnsupported: an octree cannot hold what lies that far from its origin.
[[nodiscard]] Expected<std::string> submap_bytes(const VoxelMap& map, SubmapFormat format,
                                                 const OccupancyOptions& options);

/// Whether a robot's folder can take submaps, found out before any work: it holds no scans, and no poses or submaps
/// unless `replace` and they were written by us. \return kUsage, kIo.
[[nodiscard]] Expected<void> check_robot_folder(const std::filesystem::path& folder, bool replace);

/// One robot's submaps as `folder`/submaps/000000.EXT ... and, last, `folder`/poses.tum with T_world_submap, every
/// number reading back to the same double. Replaces what an earlier run wrote; files of others stay.
/// \param stamps_ns  of each submap; empty = their numbers take the place of stamps
/// \return  bytes written; or what submap_bytes fails with, kIo, kNoSpace.
[[nodiscard]] Expected<std::size_t> write_submaps(const std::filesystem::path& folder,
                                                  const std::vector<Submap>& submaps,
                                                  const std::vector<std::int64_t>& stamps_ns, SubmapFormat format,
                                                  const OccupancyOptions& options);

}  // namespace kilter::app
