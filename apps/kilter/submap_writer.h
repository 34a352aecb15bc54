// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/kilter/staging_folder.h"
#include "kilter/base/expected.h"
#include "kilter/occupancy/occupancy_options.h"
#include "kilter/pipeline/result.h"
#include "kilter/submap/submap.h"

namespace kilter::app {

/// How a submap is kept: with free space and probabilities, with free space alone, or as points.
enum class SubmapFormat { kOt, kBt, kPcd, kPly };

[[nodiscard]] std::string extension_of(SubmapFormat format);

/// Where a robot's folder keeps its submap of this number: submaps/000000.EXT.
[[nodiscard]] std::filesystem::path submap_file(std::size_t number, SubmapFormat format);

/// One submap in its own frame. Free voxels of an octree get the log-odds of one miss; points are voxels' centroids.
/// \return  the file's bytes, or kUnsupported: an octree cannot hold what lies that far from its origin.
[[nodiscard]] Expected<std::string> submap_bytes(const VoxelMap& map, SubmapFormat format,
                                                 const OccupancyOptions& options);

/// Whether a robot's folder can take submaps, found out before any work: it holds no scans, and no poses or clouds
/// unless `replace` and they were written by us, as the first line of the poses tells. \return kUsage, kIo.
[[nodiscard]] Expected<void> check_robot_folder(const std::filesystem::path& folder, bool replace);

/// The pose graph of all submaps, beside the robots' folders.
inline constexpr const char* kPoseGraph = "submaps.g2o";

/// Its text, whose first line tells that it is ours.
[[nodiscard]] std::string pose_graph_text(const std::vector<SubmapSummary>& submaps);

/// Whether a pose graph may be written there: nothing stands there, or `replace` and one of ours. \return kUsage.
[[nodiscard]] Expected<void> check_pose_graph(const std::filesystem::path& file, bool replace);

/// Files that wait for their names, in the order in which they are to get them.
struct WaitingSubmaps {
  std::vector<std::filesystem::path> names;
  std::size_t bytes = 0;
};

/// One robot's submaps as ROBOT/submaps/000000.EXT ... and, last, ROBOT/poses.tum with T_world_submap, every number
/// reading back to the same double.
/// \param stamps_ns  of each submap; empty = their numbers take the place of stamps
/// \return  what submap_bytes fails with, kIo, kNoSpace.
[[nodiscard]] Expected<WaitingSubmaps> write_submaps(const StagingFolder& staging, const std::string& robot,
                                                     const std::vector<Submap>& submaps,
                                                     const std::vector<std::int64_t>& stamps_ns, SubmapFormat format,
                                                     const OccupancyOptions& options);

/// What an earlier run of ours wrote into a robot's folder, relative to it; poses first: without them nobody takes what
/// is left for a robot. Nothing where the poses are somebody else's. \return kIo.
[[nodiscard]] Expected<std::vector<std::filesystem::path>> earlier_submaps(const std::filesystem::path& folder);

}  // namespace kilter::app
