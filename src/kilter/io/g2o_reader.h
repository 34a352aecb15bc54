// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/io/numbered_pose.h"

namespace kilter {

/// Reads the vertices `VERTEX_SE3:QUAT id x y z qx qy qz qw` of a pose graph in g2o's text format.
///
/// Lines of other kinds (edges, FIX, parameters, vertices of other types) are skipped, so are blank lines and what
/// follows a '#'. Further columns behind the eight of a vertex are refused. Memory is bounded by the bytes.
/// \param bytes  the whole file
/// \param where  the file's name, for messages
/// \return  the poses T_world_vertex in order of their ids, at least one; or kParse (columns, a number, an id given
///          twice), kInvalidPose, both with the line; kUnsupported (a planar graph), kEmptyInput.
[[nodiscard]] Expected<std::vector<NumberedPose>> read_g2o_vertices(std::string_view bytes, const std::string& where);

/// What comments call the vertices, as constraints.g2o does: a submap's name, ROBOT/N, alone in the comment's line
/// above the vertex or behind it. Vertices without such a comment, or without a readable id, are left out.
[[nodiscard]] std::map<std::uint64_t, std::string> g2o_vertex_names(std::string_view bytes);

}  // namespace kilter
