// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/nearest_voxel.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <tuple>

#include "kilter/base/contract.h"

namespace kilter {
namespace {

constexpr std::uint32_t kNoVoxel = std::numeric_limits<std::uint32_t>::max();

// Four floats, as every 64-bit processor has them.
constexpr std::uint32_t kLanes = 4;
using Lanes = float __attribute__((vector_size(kLanes * sizeof(float))));

Lanes lanes_at(const std::vector<float>& values, std::uint32_t first) {
  Lanes lanes;
  std::memcpy(&lanes, values.data() + first, sizeof(lanes));
  return lanes;
}

// No nearer than this is a block to a point, squared; rounded down by more than floats can be wrong. [m^2]
float least_square_m2(const Eigen::Array3f& point_m, const Eigen::Array3f& low_m, float edge_m) {
  const Eigen::Array3f gap_m = (low_m - point_m).max(point_m - low_m - edge_m).max(0.0F);
  return 0.999F * gap_m.matrix().squaredNorm();
}

}  // namespace

Eigen::Vector3d voxel_position_m(const VoxelMap& map, std::size_t i, VoxelPosition position) {
  if (position == VoxelPosition::kCentroid) return map.voxels().centroids_m[i].cast<double>();
  return voxel_centre(map.indices()[i], map.resolution_m());
}

NearestVoxelSearch::NearestVoxelSearch(const VoxelMap& map, VoxelPosition position, double max_distance_m)
    : map_(&map), position_(position), max_distance_m_(max_distance_m) {
  KILTER_EXPECTS(max_distance_m > 0.0);
  const std::size_t count = map.voxels().size();
  x_.resize(count);
  y_.resize(count);
  z_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3f at = voxel_position_m(map, i, position).cast<float>();
    x_[i] = at.x();
    y_[i] = at.y();
    z_[i] = at.z();
  }
  const double edge_m = kBlockSize * map.resolution_m();
  const int reach = static_cast<int>(std::ceil(max_distance_m / edge_m));
  for (int z = -reach; z <= reach; ++z) {
    for (int y = -reach; y <= reach; ++y) {
      for (int x = -reach; x <= reach; ++x) {
        const Eigen::Vector3i offset(x, y, z);
        const Eigen::Vector3d gap_m = (offset.cwiseAbs() - Eigen::Vector3i::Ones()).cwiseMax(0).cast<double>() * edge_m;
        if (gap_m.squaredNorm() <= max_distance_m * max_distance_m) offsets_.push_back({offset, gap_m.squaredNorm()});
      }
    }
  }
  std::stable_sort(offsets_.begin(), offsets_.end(), [](const BlockOffset& a, const BlockOffset& b) {
    return std::tuple(a.least_m2, a.offset.squaredNorm()) < std::tuple(b.least_m2, b.offset.squaredNorm());
  });
}

void NearestVoxelSearch::scan_block(const VoxelBlock& block, const Eigen::Vector3f& point, float& best2,
                                    std::uint32_t& best) const {
  const std::uint32_t first = block.first_voxel;
  const std::uint32_t end = first + block.voxel_count;
  const auto square_of = [&](std::uint32_t i) {
    const float dx = x_[i] - point.x();
    const float dy = y_[i] - point.y();
    const float dz = z_[i] - point.z();
    return dx * dx + dy * dy + dz * dz;
  };
  // The least square of the block four voxels at a time, in the same operations as one at a time: same bits.
  std::uint32_t i = first;
  float least2 = std::numeric_limits<float>::max();
  if (block.voxel_count >= kLanes) {
    Lanes least = Lanes{} + least2;
    for (; i + kLanes <= end; i += kLanes) {
      const Lanes dx = lanes_at(x_, i) - point.x();
      const Lanes dy = lanes_at(y_, i) - point.y();
      const Lanes dz = lanes_at(z_, i) - point.z();
      const Lanes d2 = dx * dx + dy * dy + dz * dz;
      least = d2 < least ? d2 : least;
    }
    for (std::uint32_t lane = 0; lane < kLanes; ++lane) least2 = std::min(least2, least[lane]);
  }
  for (; i < end; ++i) least2 = std::min(least2, square_of(i));
  if (least2 > best2) return;
  for (i = first; i < end; ++i) {
    if (square_of(i) != least2) continue;
    if (least2 < best2 || i < best) {
      best2 = least2;
      best = i;
    }
    return;
  }
}

std::optional<NearestVoxel> NearestVoxelSearch::nearest(const Eigen::Vector3d& point_m, double limit_m) const {
  return NearestVoxelCursor(*this).nearest(point_m, limit_m);
}

NearestVoxelCursor::NearestVoxelCursor(const NearestVoxelSearch& search) : search_(&search), table_(64, 0) {}

NearestVoxelCursor::Home& NearestVoxelCursor::home_at(const Eigen::Vector3i& block) {
  if (last_ != 0 && homes_[last_ - 1].at == block) return homes_[last_ - 1];
  if (homes_.size() == kMostHomes) {
    homes_.clear();
    table_.assign(64, 0);
  }
  if (2 * (homes_.size() + 1) > table_.size()) {
    table_.assign(4 * table_.size(), 0);
    for (std::uint32_t number = 0; number < homes_.size(); ++number) {
      std::size_t slot = block_hash(block_key(homes_[number].at)) & (table_.size() - 1);
      while (table_[slot] != 0) slot = (slot + 1) & (table_.size() - 1);
      table_[slot] = number + 1;
    }
  }
  std::size_t slot = block_hash(block_key(block)) & (table_.size() - 1);
  while (table_[slot] != 0 && homes_[table_[slot] - 1].at != block) slot = (slot + 1) & (table_.size() - 1);
  if (table_[slot] == 0) {
    homes_.push_back({block, {}, 0});
    table_[slot] = static_cast<std::uint32_t>(homes_.size());
  }
  last_ = table_[slot];
  return homes_[last_ - 1];
}

bool NearestVoxelCursor::has_near(Home& home, std::size_t k, float best2) const {
  const VoxelMap& map = *search_->map_;
  const double edge_m = kBlockSize * map.resolution_m();
  while (k >= home.near.size()) {
    if (home.looked_at == search_->offsets_.size() || search_->offsets_[home.looked_at].least_m2 > best2) return false;
    const NearestVoxelSearch::BlockOffset& candidate = search_->offsets_[home.looked_at++];
    const Eigen::Vector3i at = home.at + candidate.offset;
    const std::int32_t number = map.find_block(at);
    if (number == BlockIndex::kNone) continue;
    const VoxelBlock& block = map.blocks()[static_cast<std::size_t>(number)];
    if (block.voxel_count == 0) continue;
    home.near.push_back(
        {(at.cast<double>() * edge_m).cast<float>().array(), static_cast<float>(candidate.least_m2), &block});
  }
  return true;
}

std::optional<NearestVoxel> NearestVoxelCursor::nearest(const Eigen::Vector3d& point_m, double limit_m) {
  KILTER_EXPECTS(limit_m <= search_->max_distance_m_ * (1.0 + 1e-12));
  const VoxelMap& map = *search_->map_;
  // Half of a pair's points lie where the other has nothing at all. A voxel's points are within it, whichever stands.
  const double reach_m = limit_m + map.resolution_m();
  if (map.bounds_m().squaredExteriorDistance(point_m) > reach_m * reach_m) return std::nullopt;
  const auto edge_m = static_cast<float>(kBlockSize * map.resolution_m());
  Home& home = home_at(block_of(voxel_at(point_m, map.resolution_m())));
  const Eigen::Vector3f point = point_m.cast<float>();
  // A little slack so that rounding to float never hides a voxel at exactly the limit; checked in double below.
  float best2 = static_cast<float>(limit_m * limit_m * 1.0001 + 1e-12);
  std::uint32_t best = kNoVoxel;
  for (std::size_t k = 0; has_near(home, k, best2); ++k) {
    const NearBlock& candidate = home.near[k];
    if (candidate.least_m2 > best2) break;
    if (least_square_m2(point.array(), candidate.low_m, edge_m) > best2 + 1e-6F) continue;
    search_->scan_block(*candidate.block, point, best2, best);
  }
  if (best == kNoVoxel) return std::nullopt;
  const double distance_m = (voxel_position_m(map, best, search_->position_) - point_m).norm();
  if (distance_m > limit_m) return std::nullopt;
  return NearestVoxel{best, distance_m};
}

}  // namespace kilter
