// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/nearest_voxel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "kilter/base/contract.h"

namespace kilter {
namespace {

using Lanes = FloatLanes;
constexpr std::uint32_t kLanes = kFloatLanes;

// How far outside an interval of the given length each of four is.
Lanes gap_m(Lanes low_m, float at_m, float edge_m) {
  const Lanes below = low_m - at_m;
  const Lanes above = at_m - low_m - edge_m;
  const Lanes gap = below > above ? below : above;
  return gap > 0.0F ? gap : Lanes{};
}

}  // namespace

Eigen::Vector3d voxel_position_m(const VoxelMap& map, std::size_t i, VoxelPosition position) {
  if (position == VoxelPosition::kCentroid) return map.voxels().centroids_m[i].cast<double>();
  return voxel_centre(map.indices()[i], map.resolution_m());
}

NearestVoxelSearch::NearestVoxelSearch(const VoxelMap& map, VoxelPosition position, double max_distance_m)
    : map_(&map),
      position_(position),
      max_distance_m_(max_distance_m),
      points_(map.voxels().size()),
      scan_(scan_points_with(vector_paths().back())) {
  KILTER_EXPECTS(max_distance_m > 0.0);
  for (std::size_t i = 0; i < map.voxels().size(); ++i) {
    const Eigen::Vector3f at = voxel_position_m(map, i, position).cast<float>();
    points_.x[i] = at.x();
    points_.y[i] = at.y();
    points_.z[i] = at.z();
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

std::optional<NearestVoxel> NearestVoxelSearch::nearest(const Eigen::Vector3d& point_m, double limit_m) const {
  return NearestVoxelCursor(*this).nearest(point_m, limit_m);
}

const NearestVoxelField* NearestVoxelSearch::field() const {
  std::call_once(field_->asked, [&] {
    if (!NearestVoxelField::fits(*map_, max_distance_m_)) return;
    field_->field = std::make_unique<const NearestVoxelField>(*map_, max_distance_m_);
  });
  return field_->field.get();
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

bool NearestVoxelCursor::extend(Home& home, float best2) const {
  const std::vector<NearestVoxelSearch::BlockOffset>& offsets = search_->offsets_;
  if (home.looked_at == offsets.size() || offsets[home.looked_at].least_m2 > best2) return false;
  constexpr float kOutOfReach_m = 1e18F;
  const VoxelMap& map = *search_->map_;
  const double edge_m = kBlockSize * map.resolution_m();
  const double least_m2 = offsets[home.looked_at].least_m2;
  Group group;
  const auto begin = [&] {
    group = Group();
    group.low_x_m = group.low_y_m = group.low_z_m = Lanes{} + kOutOfReach_m;
    group.least_m2 = static_cast<float>(least_m2);
  };
  begin();
  for (; home.looked_at < offsets.size() && offsets[home.looked_at].least_m2 == least_m2; ++home.looked_at) {
    const Eigen::Vector3i at = home.at + offsets[home.looked_at].offset;
    const std::int32_t number = map.find_block(at);
    if (number == BlockIndex::kNone) continue;
    const VoxelBlock& block = map.blocks()[static_cast<std::size_t>(number)];
    if (block.voxel_count == 0) continue;
    const Eigen::Vector3f low_m = (at.cast<double>() * edge_m).cast<float>();
    group.low_x_m[group.size] = low_m.x();
    group.low_y_m[group.size] = low_m.y();
    group.low_z_m[group.size] = low_m.z();
    group.blocks[group.size] = &block;
    if (++group.size < kLanes) continue;
    home.groups.push_back(group);
    begin();
  }
  if (group.size > 0) home.groups.push_back(group);
  return true;
}

std::optional<NearestVoxel> NearestVoxelCursor::nearest(const Eigen::Vector3d& point_m, double limit_m,
                                                        std::uint32_t hint) {
  KILTER_EXPECTS(limit_m <= search_->max_distance_m_ * (1.0 + 1e-12));
  const VoxelMap& map = *search_->map_;
  // Half of a pair's points lie where the other has nothing at all. A voxel's points are within it, whichever stands.
  const double reach_m = limit_m + map.resolution_m();
  if (map.bounds_m().squaredExteriorDistance(point_m) > reach_m * reach_m) return std::nullopt;
  const auto edge_m = static_cast<float>(kBlockSize * map.resolution_m());
  Home& home = home_at(block_of(voxel_at(point_m, map.resolution_m())));
  const Eigen::Vector3f point = point_m.cast<float>();
  // A little slack so that rounding to float never hides a voxel at exactly the limit; checked in double below.
  NearestPoint best{static_cast<float>(limit_m * limit_m * 1.0001 + 1e-12), kNoVoxel};
  if (hint != kNoVoxel) {
    if (const float square_m2 = search_->square_m2(hint, point); square_m2 <= best.square_m2) {
      best = {square_m2, hint};
    }
  }
  for (std::size_t k = 0;; ++k) {
    while (k == home.groups.size() && extend(home, best.square_m2)) {
    }
    if (k == home.groups.size() || home.groups[k].least_m2 > best.square_m2) break;
    const Group& group = home.groups[k];
    const Lanes x_m = gap_m(group.low_x_m, point.x(), edge_m);
    const Lanes y_m = gap_m(group.low_y_m, point.y(), edge_m);
    const Lanes z_m = gap_m(group.low_z_m, point.z(), edge_m);
    // Rounded down by more than floats can be wrong.
    const Lanes least2 = 0.999F * (x_m * x_m + y_m * y_m + z_m * z_m);
    for (std::uint32_t lane = 0; lane < group.size; ++lane) {
      if (least2[lane] > best.square_m2 + 1e-6F) continue;
      const VoxelBlock& block = *group.blocks[lane];
      search_->scan_(search_->points_, block.first_voxel, block.first_voxel + block.voxel_count, point.data(), best);
    }
  }
  if (best.index == kNoVoxel) return std::nullopt;
  const double distance_m = (voxel_position_m(map, best.index, search_->position_) - point_m).norm();
  if (distance_m > limit_m) return std::nullopt;
  return NearestVoxel{best.index, distance_m};
}

RepeatedSearch::RepeatedSearch(const NearestVoxelSearch& search, std::size_t points)
    : search_(&search), field_(search.field()), cursor_(search) {
  if (exact()) last_.assign(points, kNoVoxel);
}

std::optional<NearestVoxel> RepeatedSearch::near(std::size_t i, const Eigen::Vector3d& point_m, double limit_m) {
  if (exact()) {
    const std::optional<NearestVoxel> nearest = cursor_.nearest(point_m, limit_m, last_[i]);
    if (nearest) last_[i] = nearest->voxel;
    return nearest;
  }
  KILTER_EXPECTS(limit_m <= search_->max_distance_m() * (1.0 + 1e-12));
  const std::uint32_t voxel = field_->near(point_m);
  if (voxel == kNoVoxel) return std::nullopt;
  const double distance_m = (voxel_position_m(search_->map(), voxel, search_->position()) - point_m).norm();
  if (distance_m > limit_m) return std::nullopt;
  return NearestVoxel{voxel, distance_m};
}

}  // namespace kilter
