// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/occupancy/block_store.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>

#include "kilter/occupancy/scan_marks.h"

namespace kilter {
namespace {

constexpr std::size_t kMostMisses = 255;
// Lets 64 voxels of 8 bytes each, one layer of a block, be read and written at once.
constexpr std::size_t kLayer = kBlockSize * kBlockSize;

float log_odds(double probability) { return static_cast<float>(std::log(probability / (1.0 - probability))); }

// One bit for each of 64 bytes that is not zero.
std::uint64_t nonzero_bits(const std::uint8_t* bytes) {
  std::uint64_t bits = 0;
  for (int row = 0; row < 8; ++row) {
    std::uint64_t eight = 0;
    std::memcpy(&eight, bytes + 8 * row, sizeof(eight));
    eight |= (eight & 0x7F7F7F7F7F7F7F7FULL) + 0x7F7F7F7F7F7F7F7FULL;
    eight = eight >> 7 & 0x0101010101010101ULL;
    bits |= (eight * 0x0102040810204080ULL >> 56) << (8 * row);
  }
  return bits;
}

bool has_hit(BlockStore::Marks marks) {
  std::uint8_t any = 0;
  for (const std::uint8_t mark : marks) any |= mark;
  return (any & ScanMarks::kHit) != 0;
}

}  // namespace

LogOddsModel::LogOddsModel(const OccupancyOptions& options)
    : hit_(log_odds(options.probability_hit)),
      miss_(log_odds(options.probability_miss)),
      min_(log_odds(options.clamping_min)),
      max_(log_odds(options.clamping_max)),
      threshold_(log_odds(options.occupancy_threshold)) {}

BlockStore::BlockStore(const LogOddsModel& model) : model_(model), after_misses_{0.0F} {
  while (after_misses_.size() <= kMostMisses && !can_count_) {
    after_misses_.push_back(model_.after_miss(after_misses_.back()));
    can_count_ = after_misses_.back() == model_.after_miss(after_misses_.back());
  }
}

void BlockStore::apply(const Eigen::Vector3i& at, Marks marks) {
  const std::uint32_t number = numbers_.find_or_add(block_key(at));
  if (number == blocks_.size()) blocks_.emplace_back();
  Block& block = blocks_[number];
  if (!block.surface) {
    if (can_count_ && !has_hit(marks)) {
      if (!block.misses) {
        block.misses = std::make_unique<MissBlock>();
        held_bytes_ += sizeof(MissBlock);
      }
      count_misses(*block.misses, marks);
      return;
    }
    block.surface = block.misses ? surface_of(*block.misses) : std::make_unique<SurfaceBlock>();
    held_bytes_ += sizeof(SurfaceBlock) - (block.misses ? sizeof(MissBlock) : 0);
    block.misses.reset();
  }
  update(*block.surface, marks);
}

void BlockStore::count_misses(MissBlock& misses, Marks marks) const {
  const auto most = static_cast<std::uint8_t>(after_misses_.size() - 1);
  for (std::size_t i = 0; i < kBlockVoxels; ++i) {
    const auto more = static_cast<std::uint8_t>(misses[i] < most ? marks[i] : 0);
    misses[i] = static_cast<std::uint8_t>(misses[i] + more);
  }
}

std::unique_ptr<BlockStore::SurfaceBlock> BlockStore::surface_of(const MissBlock& misses) const {
  auto surface = std::make_unique<SurfaceBlock>();
  for (std::size_t z = 0; z < kBlockSize; ++z) surface->known[z] = nonzero_bits(misses.data() + kLayer * z);
  for (std::size_t i = 0; i < kBlockVoxels; ++i) surface->log_odds[i] = after_misses_[misses[i]];
  return surface;
}

void BlockStore::update(SurfaceBlock& surface, Marks marks) const {
  for (std::size_t z = 0; z < kBlockSize; ++z) surface.known[z] |= nonzero_bits(marks.data() + kLayer * z);
  for (std::size_t i = 0; i < kBlockVoxels; ++i) {
    const float value = surface.log_odds[i];
    const float missed = model_.after_miss(value);
    const float hit = model_.after_hit(value);
    surface.log_odds[i] = marks[i] == ScanMarks::kMiss ? missed : (marks[i] == ScanMarks::kHit ? hit : value);
  }
}

void BlockStore::finish_block(const Block& block, bool points_alone, VoxelBlock& out,
                              std::vector<float>& log_odds) const {
  for (std::size_t z = 0; z < kBlockSize; ++z) {
    const std::size_t first = kLayer * z;
    std::uint64_t known = block.surface ? block.surface->known[z] : nonzero_bits(block.misses->data() + first);
    for (; known != 0; known &= known - 1) {
      const std::size_t i = first + static_cast<std::size_t>(std::countr_zero(known));
      const float value = block.surface ? block.surface->log_odds[i] : after_misses_[(*block.misses)[i]];
      const std::uint64_t bit = known & (~known + 1);
      if (points_alone || model_.is_occupied(value)) {
        out.occupied[z] |= bit;
        log_odds.push_back(value);
      } else if (model_.is_free(value)) {
        out.free[z] |= bit;
      }
    }
  }
}

BlockStore::Finished BlockStore::finish(bool points_alone) {
  held_bytes_ = 0;
  std::vector<std::uint32_t> order(blocks_.size());
  std::iota(order.begin(), order.end(), 0U);
  const std::vector<std::uint64_t>& keys = numbers_.keys();
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return keys[a] < keys[b]; });
  Finished finished;
  finished.blocks.reserve(order.size());
  for (const std::uint32_t number : order) {
    VoxelBlock& out = finished.blocks.emplace_back();
    out.key = keys[number];
    out.first_voxel = static_cast<std::uint32_t>(finished.log_odds.size());
    finish_block(blocks_[number], points_alone, out, finished.log_odds);
    out.voxel_count = static_cast<std::uint32_t>(finished.log_odds.size()) - out.first_voxel;
    blocks_[number] = {};
  }
  numbers_ = {};
  std::vector<Block>().swap(blocks_);
  return finished;
}

}  // namespace kilter
