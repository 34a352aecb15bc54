// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "kilter/io/octree_format.h"
#include "kilter/occupancy/occupancy_cells.h"

namespace kilter {

/// The bytes of an OctoMap file (class OcTree) that holds these cells and nothing else.
///
/// Eight leaves of one cube that agree become one (for `.bt`: agree on being occupied or free, by
/// OccupancyCells::kOccupiedFrom, which is all that it keeps); inner nodes get the largest log-odds below them, as
/// OctoMap does. Where cells overlap the larger one stands, of equal ones the more occupied.
/// \param known  in any order
/// The same bytes for every order. O(n log n) for n cells.
[[nodiscard]] std::string octree_bytes(const OccupancyCells& known, OctreeFormat format);

}  // namespace kilter
