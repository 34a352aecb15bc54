// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "kilter/base/expected.h"
#include "kilter/geometry/point_cloud.h"
#include "kilter/occupancy/occupancy_cells.h"

namespace kilter {

/// What the cells of a `.bt` get, which keeps no probabilities: those that OctoMap gives them, its clamping limits
/// (0.1192 and 0.971).
inline constexpr float kBinaryFreeLogOdds = -2.0000279F;
inline constexpr float kBinaryOccupiedLogOdds = 3.5110307F;

/// Whether a file's name is that of an OctoMap tree, `.ot` or `.bt`, in any case of letters.
[[nodiscard]] bool has_octree_name(std::string_view file_name);

/// Reads an OctoMap tree, `.ot` or `.bt`; the first line tells which. Colours of a ColorOcTree are passed over.
///
/// Leaves above the finest level stay the cubes that they are. The way down is a stack of 16 levels, never recursion;
/// cells are 12 bytes each, at most 2.4 times (`.ot`) or 48 times (`.bt`) the bytes that hold them.
/// \param bytes  the whole file
/// \param where  the file's name, for messages
/// \return  the leaves, none for an empty tree; or what take_octree_header fails with, kTruncated (bytes end before the
///          tree), kCountMismatch (more or fewer nodes or bytes than promised), kParse (deeper than 16 levels, an inner
///          node of a `.bt` without children, a log-odds that is not finite). O(bytes).
[[nodiscard]] Expected<OccupancyCells> read_octree(std::string_view bytes, const std::string& where);

/// The same from a file. \return also what read_file fails with.
[[nodiscard]] Expected<OccupancyCells> read_octree_file(const std::filesystem::path& path);

/// The resolution that a file's first 64 kB tell, without reading the tree. [m] \return what the header fails with,
/// kIo.
[[nodiscard]] Expected<double> read_octree_resolution_m(const std::filesystem::path& path);

/// The centres of occupied cells, each counting as one point however large it is; far ones are dropped and counted.
[[nodiscard]] PointCloud occupied_centres(const OccupancyCells& known);

}  // namespace kilter
