// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/occupancy/occupancy_cells.h"

namespace kilter_testing {

/// x, y, z of the lowest cell, level, log-odds.
using OctreeRow = std::tuple<int, int, int, int, float>;

/// A tree's cells, sorted, so that two trees compare; none, and a failure, where it could not be read.
inline std::vector<OctreeRow> rows_of(const kilter::Expected<kilter::OccupancyCells>& known) {
  std::vector<OctreeRow> rows;
  if (!known) {
    ADD_FAILURE() << to_string(known.error());
    return rows;
  }
  for (const kilter::OccupancyCell& c : known->cells) {
    rows.emplace_back(c.index[0], c.index[1], c.index[2], c.level, c.log_odds);
  }
  std::sort(rows.begin(), rows.end());
  return rows;
}

}  // namespace kilter_testing
