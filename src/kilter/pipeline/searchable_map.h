// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>

#include "kilter/matching/nearest_voxel.h"
#include "kilter/occupancy/voxel_map.h"

namespace kilter {

/// Which closest-voxel searches pairs need.
struct SearchSetup {
  VoxelPosition position = VoxelPosition::kCentre;  ///< of the paper's distances
  double reach_m = 1.0;                             ///< no query asks for more. [m]
};

/// A submap's map with its closest-voxel searches: all that a pair needs to have in memory of either side. It stays
/// where it is made, for the searches know its address. Reading is safe from many threads.
class SearchableMap {
 public:
  SearchableMap(VoxelMap map, const SearchSetup& setup);
  SearchableMap(const SearchableMap&) = delete;
  SearchableMap(SearchableMap&&) = delete;
  SearchableMap& operator=(const SearchableMap&) = delete;
  SearchableMap& operator=(SearchableMap&&) = delete;
  ~SearchableMap() = default;

  [[nodiscard]] const VoxelMap& map() const { return map_; }
  /// By the points that stand for voxels in the paper's distances.
  [[nodiscard]] const NearestVoxelSearch& by_position() const { return by_position_ ? *by_position_ : by_centroid_; }
  [[nodiscard]] const NearestVoxelSearch& by_centroid() const { return by_centroid_; }
  /// Memory held by all of it. [bytes]
  [[nodiscard]] std::size_t bytes() const;

 private:
  VoxelMap map_;
  NearestVoxelSearch by_centroid_;
  std::optional<NearestVoxelSearch> by_position_;  // absent where these are the centroids
};

}  // namespace kilter
