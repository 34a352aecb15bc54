// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/pipeline/searchable_map.h"

#include <utility>

namespace kilter {

SearchableMap::SearchableMap(VoxelMap map, const SearchSetup& setup)
    : map_(std::move(map)), by_centroid_(map_, VoxelPosition::kCentroid, setup.reach_m) {
  if (setup.position != VoxelPosition::kCentroid) by_position_.emplace(map_, setup.position, setup.reach_m);
}

std::size_t SearchableMap::bytes() const {
  return map_.bytes() + by_centroid_.bytes() + (by_position_ ? by_position_->bytes() : 0);
}

}  // namespace kilter
