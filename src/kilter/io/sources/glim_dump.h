// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "kilter/geometry/point_cloud.h"
#include "kilter/io/sources/source_kind.h"

namespace kilter {

/// What kilter takes from a submap's data.txt.
struct GlimSubmap {
  Pose3 T_world_origin;                  ///< where the submap's own frame stands in the optimised map
  std::optional<std::int64_t> stamp_ns;  ///< of its first frame
};

/// Reads a submap's data.txt: lines `NAME: value`, or `NAME:` above a 4x4 matrix. Everything but `T_world_origin` and
/// the first `stamp` is passed over. \return  kParse (no T_world_origin), or what take_matrix fails with; all with the
/// file, most with the line.
[[nodiscard]] Expected<GlimSubmap> parse_glim_submap(std::string_view bytes, const std::string& where);

/// Reads points_compact.bin, float32 x y z packed, or points.bin, float64 x y z 1 packed. [m]
/// \return  the points, or kTruncated (a part of a point at the end, or no byte at all).
[[nodiscard]] Expected<PointCloud> read_glim_points(std::string_view bytes, bool compact, const std::string& where);

/// Whether a folder holds a graph.txt that begins as GLIM's does, and a submap's folder 000000 or a later one.
[[nodiscard]] bool is_glim_dump(const std::filesystem::path& folder);

/// A dump of GLIM, its submaps taken as they are: finished submaps in their own frames, at T_world_origin.
///
/// \return  one cloud for each numbered folder with a data.txt, in order of the numbers; or kEmptyInput, kNotFound (a
///          submap without points), kParse, kInvalidPose and what read_file fails with.
[[nodiscard]] Expected<RobotLog> open_glim_dump(const SourceRequest& request, std::vector<std::string>& notes);

}  // namespace kilter
