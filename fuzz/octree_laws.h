// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <string_view>

#include "kilter/io/octree_reader.h"
#include "kilter/io/octree_writer.h"
#include "reader_laws.h"

namespace kilter_fuzz {

/// A tree holds only cells that its bytes can, on their own lattice, without overlaps, and comes back from what the
/// writer makes of it; a map of it is made or refused.
inline void demand_whole_tree(std::string_view bytes, kilter::OctreeFormat format) {
  const kilter::Expected<kilter::OccupancyCells> known = kilter::read_octree(bytes, "fuzz");
  if (!known) return demand_printable(known.error());
  demand(known->cells.size() <= 4 * bytes.size());
  double volume = 0.0;
  for (const kilter::OccupancyCell& cell : known->cells) {
    demand(cell.level <= kilter::kOctreeLevels && std::isfinite(cell.log_odds));
    for (const std::int16_t low : cell.index) demand(((low + 32768) & ((1 << cell.level) - 1)) == 0);
    volume += std::ldexp(1.0, 3 * cell.level);
  }
  demand(volume <= std::ldexp(1.0, 3 * kilter::kOctreeLevels));
  const std::string written = kilter::octree_bytes(*known, format);
  const kilter::Expected<kilter::OccupancyCells> again = kilter::read_octree(written, "fuzz");
  demand(again.has_value() && again->resolution_m == known->resolution_m);
  demand(kilter::octree_bytes(*again, format) == written);
  // Coarse voxels and not many, so that an execution stays short.
  const kilter::OccupancyOptions options = {.resolution_m = known->resolution_m * 64.0};
  if (volume > std::ldexp(2000.0, 3 * 6) || known->cells.size() > 1000) return;
  const kilter::Expected<kilter::VoxelMap> map = kilter::map_from_cells(*known, options);
  demand(map.has_value() || map.error().code == kilter::ErrorCode::kUnsupported);
}

}  // namespace kilter_fuzz
