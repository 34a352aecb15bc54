// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "kilter/occupancy/key_numbers.h"
#include "kilter/occupancy/occupancy_options.h"
#include "kilter/occupancy/voxel_map.h"

namespace kilter {

/// How log-odds change, and what they mean: OctoMap's numbers, in its precision.
class LogOddsModel {
 public:
  explicit LogOddsModel(const OccupancyOptions& options);

  [[nodiscard]] float after_hit(float value) const { return std::min(value + hit_, max_); }
  [[nodiscard]] float after_miss(float value) const { return std::max(value + miss_, min_); }
  [[nodiscard]] bool is_occupied(float value) const { return value >= threshold_; }
  /// Where more must have been hit than missed, and was not, neither is known.
  [[nodiscard]] bool is_free(float value) const { return value < std::min(threshold_, 0.0F); }

 private:
  float hit_;
  float miss_;
  float min_;
  float max_;
  float threshold_;
};

/// The growing map of a MapBuilder: log-odds of every voxel that a scan has touched, in blocks.
///
/// Most blocks of a map are free space, where no ray ever ended. Such a block holds only how often each of its voxels
/// was missed, a byte each, since misses alone lead through a fixed row of log-odds that ends at the lowest kept. A
/// block's first hit turns it into one of log-odds.
class BlockStore {
 public:
  using Marks = std::span<const std::uint8_t, kBlockVoxels>;

  explicit BlockStore(const LogOddsModel& model);

  /// Adds one scan's marks (ScanMarks) of a block.
  void apply(const Eigen::Vector3i& at, Marks marks);

  [[nodiscard]] std::size_t held_bytes() const { return held_bytes_; }

  /// All blocks sorted by key, as VoxelMap has them, and the occupied voxels' log-odds. The store is empty afterwards.
  /// \param points_alone  nothing was ever missed: what is there is occupied, wherever the threshold lies.
  struct Finished {
    std::vector<VoxelBlock> blocks;
    std::vector<float> log_odds;
  };
  [[nodiscard]] Finished finish(bool points_alone = false);

 private:
  // Misses of each voxel, counted up to where they no longer change it; 0 is unknown.
  using MissBlock = std::array<std::uint8_t, kBlockVoxels>;
  struct SurfaceBlock {
    std::array<std::uint64_t, kBlockSize> known{};
    std::array<float, kBlockVoxels> log_odds{};
  };
  struct Block {
    std::unique_ptr<MissBlock> misses;  // one of the two
    std::unique_ptr<SurfaceBlock> surface;
  };

  void count_misses(MissBlock& misses, Marks marks) const;
  [[nodiscard]] std::unique_ptr<SurfaceBlock> surface_of(const MissBlock& misses) const;
  void update(SurfaceBlock& surface, Marks marks) const;
  void finish_block(const Block& block, bool points_alone, VoxelBlock& out, std::vector<float>& log_odds) const;

  LogOddsModel model_;
  std::vector<float> after_misses_;  // log-odds after so many misses and nothing else
  bool can_count_ = false;           // whether a byte can count them
  KeyNumbers numbers_;
  std::size_t held_bytes_ = 0;
  std::vector<Block> blocks_;  // by number
};

}  // namespace kilter
