// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "kilter/occupancy/occupancy_options.h"
#include "kilter/occupancy/voxel_map.h"

namespace kilter {

/// Integrates scans into one occupancy map by tracing every ray. In each scan a voxel is updated once: as a hit if any
/// ray ends in it, else as a miss if any ray passes it. The map is that of OctoMap's insertPointCloud to the last bit:
/// its rounding (points, origins and directions are floats), its traversal, its clamping. Not thread-safe.
class MapBuilder {
 public:
  explicit MapBuilder(const OccupancyOptions& options);

  /// Adds one scan. Both in the map's frame, rounded to float. [m] A point at the origin is no return. What lies off the
  /// lattice is left out. O(points * range / resolution).
  void insert_scan(std::span<const Eigen::Vector3d> points_m, const Eigen::Vector3d& origin_m);

  /// Adds points without a sensor origin: one hit for each voxel, nothing becomes free.
  void insert_points(std::span<const Eigen::Vector3d> points_m);

  /// The finished map with centroids and normals; the builder is empty afterwards.
  [[nodiscard]] VoxelMap finish();

 private:
  struct Block {
    std::uint64_t key = 0;
    std::uint32_t stamp = 0;                       // last scan that touched it
    std::array<std::uint64_t, kBlockSize> hit{};   // of the scan at hand
    std::array<std::uint64_t, kBlockSize> miss{};  // of the scan at hand
    std::array<std::uint64_t, kBlockSize> known{};
    std::array<float, kBlockVoxels> log_odds{};
  };
  struct Hit {
    Eigen::Vector3f point_m;
    std::uint32_t origin = 0;
  };

  Block& touch(const Eigen::Vector3i& block_at);
  void grow();
  void mark_hit(const Eigen::Vector3f& point_m, std::uint32_t origin);
  void trace(const Eigen::Vector3f& from_m, const Eigen::Vector3f& to_m);
  void apply_scan();
  void begin_scan();
  [[nodiscard]] SurfaceVoxels summarise_hits(const std::vector<VoxelBlock>& occupied) const;

  OccupancyOptions options_;
  float log_odds_hit_;
  float log_odds_miss_;
  float log_odds_min_;
  float log_odds_max_;
  float log_odds_threshold_;
  std::uint32_t stamp_ = 0;
  bool has_free_space_ = false;
  std::deque<Block> blocks_;
  std::vector<std::uint32_t> table_;  // open addressing: block number + 1, 0 = empty
  std::vector<std::uint32_t> touched_;
  std::vector<Hit> hits_;
  std::vector<Eigen::Vector3f> origins_m_;
};

}  // namespace kilter
