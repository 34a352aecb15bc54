// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kilter/io/sources/source_kind.h"

namespace kilter {

/// Whether a folder holds local_maps/local_map_graph.g2o.
[[nodiscard]] bool is_kiss_slam_result(const std::filesystem::path& folder);

/// Results of KISS-SLAM: its local maps as finished submaps, at the graph's vertices of the same numbers.
///
/// KISS-SLAM writes the points of local_maps/plys/000012.ply in the world's frame, moved by the map's key pose; they
/// are moved back when read, so that a submap has its own frame and other poses (--poses) move it. \return  one cloud
/// for each PLY file with a vertex, in order of their names; the vertex of the last, empty local map
///          has none and is passed over. Or kEmptyInput, kCountMismatch, kUnsupported, what read_g2o_vertices fails
///          with.
[[nodiscard]] Expected<RobotLog> open_kiss_slam_result(const SourceRequest& request, std::vector<std::string>& notes);

}  // namespace kilter
