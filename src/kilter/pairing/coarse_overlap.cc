// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/pairing/coarse_overlap.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace kilter {

CoarseMap::CoarseMap(const VoxelMap& map, std::size_t max_cells)
    : bounds_m_(map.bounds_m()), resolution_m_(map.resolution_m()) {
  std::vector<const VoxelBlock*> filled;
  std::vector<std::uint64_t> keys;
  for (const VoxelBlock& block : map.blocks()) {
    if (block.voxel_count == 0) continue;
    filled.push_back(&block);
    keys.push_back(block.key);
  }
  if (filled.empty()) return;
  filled_ = BlockIndex(keys);
  const std::size_t count = std::min(max_cells, filled.size());
  double picked_weight = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const VoxelBlock& block = *filled[k * filled.size() / count];
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::uint32_t i = 0; i < block.voxel_count; ++i) {
      sum += map.voxels().centroids_m[block.first_voxel + i].cast<double>();
    }
    cells_.centres_m.emplace_back(sum / block.voxel_count);
    cells_.weights.push_back(block.voxel_count);
    picked_weight += block.voxel_count;
  }
  const double scale = static_cast<double>(map.voxels().size()) / picked_weight;
  for (double& weight : cells_.weights) weight *= scale;
}

bool CoarseMap::surface_near(const Eigen::Vector3d& at_m) const {
  // Everything within half a block is seen.
  const Eigen::Vector3i low = block_of(voxel_at(at_m - Eigen::Vector3d::Constant(0.5 * block_m()), resolution_m_));
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3i block = low + Eigen::Vector3i(corner & 1, corner >> 1 & 1, corner >> 2);
    if (filled_.find(block) != BlockIndex::kNone) return true;
  }
  return false;
}

CoarseOverlap coarse_overlap(const CoarseMap& source, const CoarseMap& target, const Pose3& T_target_source,
                             const Eigen::Vector3d& shift_m) {
  CoarseOverlap result;
  result.shift_m = shift_m;
  double inside = 0.0;
  // Half a block wider, as surface_near looks: a wall's box is thinner than the errors that matter.
  Eigen::AlignedBox3d box = target.bounds_m();
  const double half_m = 0.5 * target.block_m();
  box.min().array() -= half_m;
  box.max().array() += half_m;
  const CoarseCells& cells = source.cells();
  for (std::size_t i = 0; i < cells.centres_m.size(); ++i) {
    const Eigen::Vector3d at_m = T_target_source * cells.centres_m[i] + shift_m;
    if (!box.contains(at_m)) continue;
    inside += cells.weights[i];
    if (target.surface_near(at_m)) result.matched += cells.weights[i];
  }
  result.overlap = inside > 0.0 ? result.matched / inside : 0.0;
  return result;
}

namespace {

// Two horizontal axes of a frame: its own x and y where it stands level enough that a shift by the whole reach leaves
// the height by less than half a block, which is as good as seen (a sensor that is mounted on its side does not).
std::array<Eigen::Vector3d, 2> horizontal_axes(const Eigen::Vector3d& up, double reach_m, double block_m) {
  const double rise = up.head<2>().norm();  // the sine of how far x and y lead up
  if (up.z() > 0.0 && rise * reach_m < 0.5 * block_m) return {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY()};
  const Eigen::Vector3d beside = std::abs(up.x()) < 0.7 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  const Eigen::Vector3d first = (beside - beside.dot(up) * up).normalized();
  return {first, up.cross(first)};
}

}  // namespace

CoarseOverlap best_coarse_overlap(const CoarseMap& source, const CoarseMap& target, const Pose3& T_target_source,
                                  double reach_m, const Eigen::Vector3d& up_target) {
  CoarseOverlap best = coarse_overlap(source, target, T_target_source, Eigen::Vector3d::Zero());
  const double step_m = 2.0 * target.block_m();
  const int steps = static_cast<int>(std::floor(reach_m / step_m));
  const auto [across, along] = horizontal_axes(up_target, reach_m, target.block_m());
  for (int y = -steps; y <= steps; ++y) {
    for (int x = -steps; x <= steps; ++x) {
      const Eigen::Vector3d shift_m = step_m * x * across + step_m * y * along;
      if (shift_m.norm() > reach_m || (x == 0 && y == 0)) continue;
      const CoarseOverlap here = coarse_overlap(source, target, T_target_source, shift_m);
      const bool better = here.matched > best.matched;
      const bool as_good_but_nearer = here.matched == best.matched && shift_m.norm() < best.shift_m.norm();
      if (better || as_good_but_nearer) best = here;
    }
  }
  return best;
}

}  // namespace kilter
