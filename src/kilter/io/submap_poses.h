// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/io/cuts.h"
#include "kilter/submap/robot_log.h"

namespace kilter {

/// How far a submap was moved: its origin, and by which angle it turned.
struct SubmapMove {
  double distance_m = 0.0;
  double angle_rad = 0.0;
};

/// Moves submaps to where an optimiser put the vertices of constraints.g2o; a submap's scans go with it as one body.
///
/// A vertex's id is the submap's number from 0: all of the first robot, then the second, ... Scans [first, last] of a
/// submap then have T_world_scan[k] = T_world_vertex * T_world_scan[first]^-1 * T_world_scan[k], since a submap's frame
/// is that of its first scan.
/// \param bytes   the whole file, in g2o's text format; edges are passed over
/// \param where   the file's name, for messages
/// \param cuts    where each robot's scans were cut; finished submaps are not looked up
/// \param robots  of the mission, sorted by name; unchanged where this fails
/// \return  how each submap moved, in order of ids; what read_g2o_vertices fails with; or kCountMismatch (scans without
///          cuts, cuts for other scans, as many vertices as submaps are expected, with ids from 0, and where comments
///          name submaps, with their names).
[[nodiscard]] Expected<std::vector<SubmapMove>> move_submaps(std::string_view bytes, const std::string& where,
                                                             const Cuts& cuts, std::vector<RobotLog>& robots);

/// The same of a file. \return also what read_file fails with.
[[nodiscard]] Expected<std::vector<SubmapMove>> move_submaps(const std::filesystem::path& graph, const Cuts& cuts,
                                                             std::vector<RobotLog>& robots);

}  // namespace kilter
