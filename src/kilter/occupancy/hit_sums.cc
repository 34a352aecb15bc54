// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/occupancy/hit_sums.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "kilter/base/contract.h"

namespace kilter {
namespace {

// A voxel's sum and its numbers take what six or seven hits do: below twice that summing hits would save little.
constexpr std::size_t kHitsOfAVoxel = 12;
constexpr std::size_t kSmallestPart = std::size_t{1} << 12;
constexpr std::size_t kLargestPart = std::size_t{1} << 19;
constexpr int kBitBits = 3 * kBlockShift;

// Number of an occupied voxel among all, if it is one.
class OccupiedVoxels {
 public:
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  explicit OccupiedVoxels(std::span<const VoxelBlock> blocks) : blocks_(blocks) {
    std::vector<std::uint64_t> keys(blocks.size());
    std::transform(blocks.begin(), blocks.end(), keys.begin(), [](const VoxelBlock& block) { return block.key; });
    index_ = BlockIndex(keys);
  }

  [[nodiscard]] std::size_t count() const {
    return blocks_.empty() ? 0 : blocks_.back().first_voxel + blocks_.back().voxel_count;
  }

  [[nodiscard]] std::size_t find(const Eigen::Vector3i& block_at, int bit) const {
    const std::int32_t number = index_.find(block_at);
    KILTER_EXPECTS(number != BlockIndex::kNone);
    if (number == BlockIndex::kNone) return kNone;  // cannot be; if it is, a hit is lost rather than memory read
    const VoxelBlock& block = blocks_[static_cast<std::size_t>(number)];
    if ((block.occupied[static_cast<std::size_t>(bit >> 6)] >> (bit & 63) & 1) == 0) return kNone;
    return block.first_voxel + rank_in_block(block, bit);
  }

 private:
  std::span<const VoxelBlock> blocks_;
  BlockIndex index_;
};

}  // namespace

void HitSums::Sum::add(const Hit& hit, std::span<const Eigen::Vector3f> origins_m) {
  const Eigen::Vector3d at_m = hit.point_m.cast<double>();
  point_m += at_m;
  ++count;
  if (hit.origin == kNoOrigin) return;
  view += (origins_m[hit.origin].cast<double>() - at_m).normalized();
  time += hit.origin;
}

void HitSums::add_part() { parts_.emplace_back().reserve(std::clamp(kept_, kSmallestPart, kLargestPart)); }

void HitSums::sum_up_if_many(std::span<const Eigen::Vector3f> origins_m) {
  if (kept_ < sum_at_) return;
  if (number_voxels()) {
    sum_up(origins_m);
    sum_at_ = many_hits_;
  } else {
    sum_at_ = 2 * kept_;
  }
}

std::size_t HitSums::held_bytes() const {
  constexpr std::size_t kNumberBytes = 2 * sizeof(std::uint64_t);
  return kept_ * sizeof(Hit) + sums_.size() * sizeof(Sum) + (blocks_.size() + voxels_.size()) * kNumberBytes;
}

std::uint32_t HitSums::number_of(const Eigen::Vector3f& point_m) {
  const VoxelIndex voxel = voxel_at(point_m.cast<double>(), resolution_m_);
  const std::uint64_t block = blocks_.find_or_add(block_key(block_of(voxel)));
  return voxels_.find_or_add(block << kBitBits | static_cast<std::uint64_t>(bit_of(voxel)));
}

// Whether the hits fall into so few voxels that summing them saves memory. If not, the numbers so far stay for next
// time: they are few.
bool HitSums::number_voxels() {
  const std::size_t most = sums_.size() + kept_ / kHitsOfAVoxel;
  for (const std::vector<Hit>& part : parts_) {
    for (const Hit& hit : part) {
      static_cast<void>(number_of(hit.point_m));
      if (voxels_.size() > most) return false;
    }
  }
  return true;
}

void HitSums::sum_up(std::span<const Eigen::Vector3f> origins_m) {
  sums_.resize(voxels_.size());
  for (const std::vector<Hit>& part : parts_) {
    for (const Hit& hit : part) sums_[number_of(hit.point_m)].add(hit, origins_m);
  }
  kept_ = 0;
  parts_.clear();
}

// What was summed came first, so that what is left goes on from there.
std::vector<HitSums::Sum> HitSums::sums_of(std::span<const VoxelBlock> occupied,
                                           std::span<const Eigen::Vector3f> origins_m) const {
  const OccupiedVoxels voxels(occupied);
  std::vector<Sum> sums(voxels.count());
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    const std::uint64_t key = voxels_.keys()[i];
    const Eigen::Vector3i block = block_of_key(blocks_.keys()[key >> kBitBits]);
    const std::size_t to = voxels.find(block, static_cast<int>(key & (kBlockVoxels - 1)));
    if (to != OccupiedVoxels::kNone) sums[to] = sums_[i];
  }
  for (const std::vector<Hit>& part : parts_) {
    for (const Hit& hit : part) {
      const VoxelIndex voxel = voxel_at(hit.point_m.cast<double>(), resolution_m_);
      const std::size_t to = voxels.find(block_of(voxel), bit_of(voxel));
      if (to != OccupiedVoxels::kNone) sums[to].add(hit, origins_m);
    }
  }
  return sums;
}

SurfaceVoxels HitSums::summarise(std::span<const VoxelBlock> occupied,
                                 std::span<const Eigen::Vector3f> origins_m) const {
  const std::vector<Sum> sums = sums_of(occupied, origins_m);
  SurfaceVoxels voxels;
  voxels.centroids_m.resize(sums.size());
  voxels.normals.resize(sums.size());
  voxels.planarity.assign(sums.size(), 0.0F);
  voxels.seen_at.assign(sums.size(), 0);
  voxels.hits.assign(sums.size(), 1);
  const double last = origins_m.size() > 1 ? static_cast<double>(origins_m.size() - 1) : 1.0;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (sums[i].count == 0) continue;
    voxels.hits[i] = static_cast<std::uint16_t>(std::min<std::uint32_t>(sums[i].count, 0xFFFF));
    voxels.seen_at[i] = static_cast<std::uint8_t>(std::lround(255.0 * sums[i].time / sums[i].count / last));
  }
  for (const VoxelBlock& block : occupied) {
    const Eigen::Vector3i at = block_of_key(block.key);
    std::size_t i = block.first_voxel;
    for (int z = 0; z < kBlockSize; ++z) {
      for (std::uint64_t bits = block.occupied[static_cast<std::size_t>(z)]; bits != 0; bits &= bits - 1, ++i) {
        const VoxelIndex voxel = voxel_of(at, std::countr_zero(bits) + 64 * z);
        const Eigen::Vector3d mean_m =
            sums[i].count > 0 ? Eigen::Vector3d(sums[i].point_m / sums[i].count) : voxel_centre(voxel, resolution_m_);
        voxels.centroids_m[i] = mean_m.cast<float>();
        voxels.normals[i] = sums[i].view.cast<float>();
      }
    }
  }
  return voxels;
}

}  // namespace kilter
