// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <vector>

#include "kilter/base/vector_path.h"
#include "kilter/matching/field_block.h"
#include "kilter/matching/look_up.h"
#include "kilter/matching/point_columns.h"
#include "kilter/occupancy/voxel_map.h"

namespace kilter {

/// For every cell of a map's lattice the occupied voxel whose centre is nearest to the cell's centre, if one is within
/// reach; of equally near ones that of the lowest z, then y, then x. One look-up says which voxel a point has near it:
/// the nearest one or, where it takes another point of the cell to see that, one that is farther by less than two
/// cells' diagonals, a twentieth of a cell on average. Registration can do with that; the paper's distances cannot,
/// their mean would grow by up to 6 %.
///
/// Blocks are computed when a point first falls into them, from any thread, and kept: 2 KB each. What stands in them
/// does not depend on when or on which processor. The map must outlive the field.
class NearestVoxelField {
 public:
  /// Whether the field of such a map is small enough to be worth it: a reach of up to 24 voxels, and a box that holds
  /// up to 4 million blocks. Where it is not, the exact search has to do.
  [[nodiscard]] static bool fits(const VoxelMap& map, double reach_m);

  /// \param reach_m  no query may ask for more. Precondition: fits(map, reach_m).
  NearestVoxelField(const VoxelMap& map, double reach_m, VectorPath path = vector_paths().back());

  /// A voxel near a point of the map's frame, or kNoVoxel: then no voxel's point is within reach_m of it.
  [[nodiscard]] std::uint32_t near(const Eigen::Vector3d& point_m) const;

  /// The same for the first `count` points of a batch.
  void near(const PointColumns& points_m, std::size_t count, VoxelColumn& voxels) const;

  /// Where near() reads what it says of a point. Stays valid.
  [[nodiscard]] const std::uint32_t* where(const Eigen::Vector3d& point_m) const;

  /// Memory that blocks and the pages of their table hold by now; depends on what was asked. [bytes]
  [[nodiscard]] std::size_t bytes() const;

 private:
  static constexpr std::size_t kSlotBytes = sizeof(void*);  // of table_
  struct Free {
    void operator()(void* memory) const { std::free(memory); }  // NOLINT(cppcoreguidelines-no-malloc): calloc's
  };

  void find_places(const PointColumns& points_m, std::size_t count, CellPlaces& places) const;
  const FieldCell* build(std::int32_t slot) const;

  const VoxelMap* map_;
  int reach_;  // cells between the centres of a point's cell and of its voxel
  VectorPath path_;
  FieldBox box_;
  OccupiedBlocks occupied_;
  // Null where nobody has looked yet; pages that nobody touches cost nothing.
  std::unique_ptr<const FieldCell*[], Free> table_;
  mutable std::mutex building_;
  mutable std::vector<std::unique_ptr<const FieldBlock>> blocks_;
  mutable std::size_t touched_ = 0;  // places of the table, those with nothing near included
};

}  // namespace kilter
