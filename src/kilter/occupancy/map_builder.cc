// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/occupancy/map_builder.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

#include "kilter/base/contract.h"
#include "kilter/occupancy/surface_normals.h"

namespace kilter {
namespace {

constexpr std::uint32_t kNoOrigin = std::numeric_limits<std::uint32_t>::max();

float log_odds(double probability) { return static_cast<float>(std::log(probability / (1.0 - probability))); }

bool on_lattice(const Eigen::Vector3d& point_m, double resolution_m) {
  return point_m.allFinite() && point_m.cwiseAbs().maxCoeff() < resolution_m * (kMaxVoxelIndex - 1);
}

// In the order and precision of OctoMap's Vector3: squares are floats, the root is a double.
double length_m(const Eigen::Vector3f& v) {
  return std::sqrt(static_cast<double>(v.x() * v.x() + v.y() * v.y() + v.z() * v.z()));
}

}  // namespace

MapBuilder::MapBuilder(const OccupancyOptions& options)
    : options_(options),
      log_odds_hit_(log_odds(options.probability_hit)),
      log_odds_miss_(log_odds(options.probability_miss)),
      log_odds_min_(log_odds(options.clamping_min)),
      log_odds_max_(log_odds(options.clamping_max)),
      log_odds_threshold_(log_odds(options.occupancy_threshold)),
      table_(1024, 0) {}

void MapBuilder::insert_scan(std::span<const Eigen::Vector3d> points_m, const Eigen::Vector3d& origin_m) {
  if (!on_lattice(origin_m, options_.resolution_m)) return;
  begin_scan();
  has_free_space_ = true;
  const auto origin = static_cast<std::uint32_t>(origins_m_.size());
  const Eigen::Vector3f from_m = origin_m.cast<float>();
  origins_m_.push_back(from_m);
  for (const Eigen::Vector3d& point_m : points_m) {
    if (!on_lattice(point_m, options_.resolution_m)) continue;
    const Eigen::Vector3f to_m = point_m.cast<float>();
    const double range_m = length_m(to_m - from_m);
    if (!(range_m >= options_.min_range_m) || range_m == 0.0) continue;
    if (range_m <= options_.max_range_m) {
      mark_hit(to_m, origin);
      trace(from_m, to_m);
    } else {
      const Eigen::Vector3f direction = (to_m - from_m) / static_cast<float>(range_m);
      trace(from_m, from_m + direction * static_cast<float>(options_.max_range_m));
    }
  }
  apply_scan();
}

void MapBuilder::insert_points(std::span<const Eigen::Vector3d> points_m) {
  begin_scan();
  for (const Eigen::Vector3d& point_m : points_m) {
    if (on_lattice(point_m, options_.resolution_m)) mark_hit(point_m.cast<float>(), kNoOrigin);
  }
  apply_scan();
}

void MapBuilder::begin_scan() {
  ++stamp_;
  touched_.clear();
}

MapBuilder::Block& MapBuilder::touch(const Eigen::Vector3i& block_at) {
  const std::uint64_t key = block_key(block_at);
  std::size_t slot = block_hash(key) & (table_.size() - 1);
  while (table_[slot] != 0 && blocks_[table_[slot] - 1].key != key) slot = (slot + 1) & (table_.size() - 1);
  if (table_[slot] == 0) {
    blocks_.emplace_back();
    blocks_.back().key = key;
    table_[slot] = static_cast<std::uint32_t>(blocks_.size());
    if (2 * blocks_.size() > table_.size()) {
      grow();
      return touch(block_at);
    }
  }
  Block& block = blocks_[table_[slot] - 1];
  if (block.stamp != stamp_) {
    block.stamp = stamp_;
    block.hit.fill(0);
    block.miss.fill(0);
    touched_.push_back(table_[slot] - 1);
  }
  return block;
}

void MapBuilder::grow() {
  table_.assign(table_.size() * 4, 0);
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    std::size_t slot = block_hash(blocks_[i].key) & (table_.size() - 1);
    while (table_[slot] != 0) slot = (slot + 1) & (table_.size() - 1);
    table_[slot] = static_cast<std::uint32_t>(i + 1);
  }
}

void MapBuilder::mark_hit(const Eigen::Vector3f& point_m, std::uint32_t origin) {
  const VoxelIndex voxel = voxel_at(point_m.cast<double>(), options_.resolution_m);
  const int bit = bit_of(voxel);
  touch(block_of(voxel)).hit[static_cast<std::size_t>(bit >> 6)] |= std::uint64_t{1} << (bit & 63);
  hits_.push_back({point_m, origin});
}

// Amanatides and Woo's traversal as OctoMap's computeRayKeys has it, in the same precision: marks every voxel from
// `from_m` up to, not including, that of `to_m`. Where rounding leads it past that voxel, the ray's length ends it.
void MapBuilder::trace(const Eigen::Vector3f& from_m, const Eigen::Vector3f& to_m) {
  const double r = options_.resolution_m;
  VoxelIndex voxel = voxel_at(from_m.cast<double>(), r);
  const VoxelIndex last = voxel_at(to_m.cast<double>(), r);
  if (voxel == last) return;
  const auto range_m = static_cast<float>(length_m(to_m - from_m));
  const Eigen::Vector3f direction = (to_m - from_m) / range_m;
  Eigen::Vector3i step = Eigen::Vector3i::Zero();
  Eigen::Vector3d next_m = Eigen::Vector3d::Constant(std::numeric_limits<double>::max());
  Eigen::Vector3d delta_m = next_m;
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0F) continue;
    step[axis] = direction[axis] > 0.0F ? 1 : -1;
    const double border_m = (voxel[axis] + 0.5) * r + static_cast<float>(step[axis] * r * 0.5);
    next_m[axis] = (border_m - from_m[axis]) / direction[axis];
    delta_m[axis] = r / std::abs(direction[axis]);
  }
  Eigen::Vector3i at = block_of(voxel);
  Block* block = &touch(at);
  while (true) {
    const int bit = bit_of(voxel);
    block->miss[static_cast<std::size_t>(bit >> 6)] |= std::uint64_t{1} << (bit & 63);
    const int axis = next_m.x() < next_m.y() ? (next_m.x() < next_m.z() ? 0 : 2) : (next_m.y() < next_m.z() ? 1 : 2);
    voxel[axis] += step[axis];
    next_m[axis] += delta_m[axis];
    if (voxel == last || next_m.minCoeff() > range_m) return;
    if (voxel[axis] >> kBlockShift != at[axis]) {
      at[axis] = voxel[axis] >> kBlockShift;
      block = &touch(at);
    }
  }
}

void MapBuilder::apply_scan() {
  for (const std::uint32_t number : touched_) {
    Block& block = blocks_[number];
    for (std::size_t z = 0; z < kBlockSize; ++z) {
      const std::uint64_t hit = block.hit[z];
      block.known[z] |= hit | block.miss[z];
      for (std::uint64_t bits = block.miss[z] & ~hit; bits != 0; bits &= bits - 1) {
        float& value = block.log_odds[64 * z + static_cast<std::size_t>(std::countr_zero(bits))];
        value = std::max(value + log_odds_miss_, log_odds_min_);
      }
      for (std::uint64_t bits = hit; bits != 0; bits &= bits - 1) {
        float& value = block.log_odds[64 * z + static_cast<std::size_t>(std::countr_zero(bits))];
        value = std::min(value + log_odds_hit_, log_odds_max_);
      }
    }
  }
}

VoxelMap MapBuilder::finish() {
  std::vector<std::uint32_t> order(blocks_.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return blocks_[a].key < blocks_[b].key; });
  std::vector<VoxelBlock> finished;
  finished.reserve(order.size());
  std::vector<float> voxel_log_odds;
  for (const std::uint32_t number : order) {
    const Block& block = blocks_[number];
    VoxelBlock out;
    out.key = block.key;
    out.first_voxel = static_cast<std::uint32_t>(voxel_log_odds.size());
    for (std::size_t z = 0; z < kBlockSize; ++z) {
      for (std::uint64_t bits = block.known[z]; bits != 0; bits &= bits - 1) {
        const float value = block.log_odds[64 * z + static_cast<std::size_t>(std::countr_zero(bits))];
        const bool occupied = value >= log_odds_threshold_;
        (occupied ? out.occupied : out.free)[z] |= bits & (~bits + 1);
        if (occupied) voxel_log_odds.push_back(value);
      }
    }
    out.voxel_count = static_cast<std::uint32_t>(voxel_log_odds.size()) - out.first_voxel;
    finished.push_back(out);
  }
  blocks_.clear();
  std::vector<std::uint32_t>(1024, 0).swap(table_);
  SurfaceVoxels voxels = summarise_hits(finished);
  voxels.log_odds = std::move(voxel_log_odds);
  std::vector<Hit>().swap(hits_);
  VoxelMap map(options_.resolution_m, has_free_space_, std::move(finished), std::move(voxels));
  return with_surface_normals(map);
}

// Means of the hits inside each voxel that ended up occupied; `normals` holds the mean viewing direction for now, which
// is what with_surface_normals orients by.
SurfaceVoxels MapBuilder::summarise_hits(const std::vector<VoxelBlock>& occupied) const {
  std::vector<std::uint64_t> keys(occupied.size());
  std::transform(occupied.begin(), occupied.end(), keys.begin(), [](const VoxelBlock& block) { return block.key; });
  const BlockIndex index(keys);
  const std::size_t count = occupied.empty() ? 0 : occupied.back().first_voxel + occupied.back().voxel_count;
  std::vector<Eigen::Vector3d> sums(count, Eigen::Vector3d::Zero());
  std::vector<Eigen::Vector3d> views(count, Eigen::Vector3d::Zero());
  std::vector<std::uint32_t> counts(count, 0);
  std::vector<double> times(count, 0.0);
  for (const Hit& hit : hits_) {
    const Eigen::Vector3d point_m = hit.point_m.cast<double>();
    const VoxelIndex voxel = voxel_at(point_m, options_.resolution_m);
    const std::int32_t number = index.find(block_of(voxel));
    KILTER_EXPECTS(number != BlockIndex::kNone);
    const VoxelBlock& block = occupied[static_cast<std::size_t>(number)];
    const int bit = bit_of(voxel);
    if ((block.occupied[static_cast<std::size_t>(bit >> 6)] >> (bit & 63) & 1) == 0) continue;
    const std::size_t i = block.first_voxel + rank_in_block(block, bit);
    sums[i] += point_m;
    ++counts[i];
    if (hit.origin == kNoOrigin) continue;
    views[i] += (origins_m_[hit.origin].cast<double>() - point_m).normalized();
    times[i] += hit.origin;
  }
  SurfaceVoxels voxels;
  voxels.centroids_m.resize(count);
  voxels.normals.resize(count);
  voxels.planarity.assign(count, 0.0F);
  voxels.seen_at.assign(count, 0);
  const double last = origins_m_.size() > 1 ? static_cast<double>(origins_m_.size() - 1) : 1.0;
  for (std::size_t i = 0; i < count; ++i) {
    if (counts[i] > 0) voxels.seen_at[i] = static_cast<std::uint8_t>(std::lround(255.0 * times[i] / counts[i] / last));
  }
  for (const VoxelBlock& block : occupied) {
    const Eigen::Vector3i at = block_of_key(block.key);
    std::size_t i = block.first_voxel;
    for (int z = 0; z < kBlockSize; ++z) {
      for (std::uint64_t bits = block.occupied[static_cast<std::size_t>(z)]; bits != 0; bits &= bits - 1, ++i) {
        const VoxelIndex voxel = voxel_of(at, std::countr_zero(bits) + 64 * z);
        const Eigen::Vector3d mean_m =
            counts[i] > 0 ? Eigen::Vector3d(sums[i] / counts[i]) : voxel_centre(voxel, options_.resolution_m);
        voxels.centroids_m[i] = mean_m.cast<float>();
        voxels.normals[i] = views[i].cast<float>();
      }
    }
  }
  return voxels;
}

}  // namespace kilter
