// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "kilter/matching/nearest_voxel_field.h"
#include "kilter/matching/scan_clusters.h"
#include "kilter/matching/voxel_clusters.h"
#include "kilter/occupancy/key_numbers.h"
#include "kilter/occupancy/voxel_map.h"

namespace kilter {

/// An occupied voxel and how far it is. [m]
struct NearestVoxel {
  std::uint32_t voxel = 0;
  double distance_m = 0.0;
};

/// Exact closest-voxel search on one map: voxels in clusters of up to sixteen with tight boxes, the clusters around a
/// point's block in order of their distance from it, as many at once as the processor has lanes. Immutable after
/// construction; the map must outlive it. Ties go to the lower voxel number.
class NearestVoxelSearch {
 public:
  /// \param max_distance_m  no query may ask for more. O(voxels).
  /// \param path  which instructions it uses; the answers are the same to the bit.
  NearestVoxelSearch(const VoxelMap& map, VoxelPosition position, double max_distance_m,
                     VectorPath path = vector_paths().back());

  /// The closest occupied voxel no farther than `limit_m` (<= max_distance_m) from a point in the map's frame.
  [[nodiscard]] std::optional<NearestVoxel> nearest(const Eigen::Vector3d& point_m, double limit_m) const;

  /// The field of the same map and reach, for those who look often and can do with what it says; made when first asked
  /// for, from any thread. Null where it would be too large (NearestVoxelField::fits).
  [[nodiscard]] const NearestVoxelField* field() const;

  [[nodiscard]] const VoxelMap& map() const { return *map_; }
  [[nodiscard]] VoxelPosition position() const { return position_; }
  [[nodiscard]] double max_distance_m() const { return max_distance_m_; }
  [[nodiscard]] VectorPath path() const { return path_; }
  [[nodiscard]] const VoxelClusters& clusters() const { return clusters_; }
  /// Memory held by now, the field's included and the map's own left out. Grows with what was asked of the field.
  /// [bytes]
  [[nodiscard]] std::size_t bytes() const;

 private:
  friend class NearestVoxelCursor;
  struct LazyField {
    std::once_flag asked;
    std::unique_ptr<const NearestVoxelField> field;
    std::atomic<const NearestVoxelField*> made = nullptr;  // for who counts bytes while another thread makes it
  };
  // What is looked at in one step: clusters of certain blocks around the home block, at certain distances from its box.
  struct Step {
    std::uint32_t first = 0;  // of the runs; none where the step goes on with what the one before has left
    std::uint32_t end = 0;
    float from_m2 = 0.0F;  // clusters whose square distance is in [from, to)
    float to_m2 = std::numeric_limits<float>::max();
    float least_m2 = 0.0F;  // nobody in the home block is nearer to any of them
  };

  // Blocks of one row, seen from the home block, that a step looks at.
  struct Run {
    int x_first = 0;
    int x_end = 0;
    int y = 0;
    int z = 0;
  };
  void plan_steps();

  const VoxelMap* map_;
  VoxelPosition position_;
  double max_distance_m_;
  VectorPath path_;
  VoxelClusters clusters_;
  ScanClusters scan_;
  std::vector<Run> runs_;    // of blocks that may hold what is near
  std::vector<Step> steps_;  // sorted by least distance
  std::unique_ptr<LazyField> field_ = std::make_unique<LazyField>();
};

/// The same search for many points: remembers which of the blocks around a point's block hold surfaces, so that points
/// near each other, and the same points under another pose, look nothing up. Same answers to the bit. One for each
/// thread; keep it as long as poses of one pair change. Memory is bounded (kMostHomes, kMostGroups).
class NearestVoxelCursor {
 public:
  /// The search must outlive it.
  explicit NearestVoxelCursor(const NearestVoxelSearch& search);

  /// \sa NearestVoxelSearch::nearest
  /// \param hint  a voxel that may be near, say what the point had under the last pose. It changes the time, never the
  ///              answer.
  [[nodiscard]] std::optional<NearestVoxel> nearest(const Eigen::Vector3d& point_m, double limit_m,
                                                    std::uint32_t hint = kNoVoxel);

  [[nodiscard]] const NearestVoxelSearch& search() const { return *search_; }
  [[nodiscard]] const VoxelMap& map() const { return search_->map(); }

 private:
  static constexpr std::size_t kMostHomes = 1 << 13;
  static constexpr std::size_t kMostGroups = 1 << 15;  // of all homes: 17 MB

  // A cluster of a block that was looked at, farther than the step went.
  struct Farther {
    std::uint32_t cluster = 0;
    float gap_m2 = 0.0F;
  };

  // What lies around one block, sorted by least distance, as far as was needed yet.
  struct Home {
    Eigen::Vector3i at;
    std::vector<ClusterGroup> groups;
    std::vector<Farther> farther;
    std::size_t steps = 0;  // that `groups` cover
  };

  Home& home_at(const Eigen::Vector3i& block);
  // Takes the next step. \return false when there is none, or none that may find something as near as best_m2.
  bool extend(Home& home, float best_m2) const;

  const NearestVoxelSearch* search_;
  KeyNumbers numbers_;                   // of blocks
  std::vector<Home> homes_;              // by number
  std::size_t groups_ = 0;               // of all homes
  std::uint32_t last_voxel_ = kNoVoxel;  // what the last point had nearest
};

/// Voxels near the points of one submap under many poses, for registration: by the field's one look-up where the map
/// allows one, by the exact search where not. One for each thread and pair.
class RepeatedSearch {
 public:
  /// \param search  of centroids; must outlive it.
  /// \param points  how many points will ask.
  RepeatedSearch(const NearestVoxelSearch& search, std::size_t points);

  /// What is near each point of a batch: a voxel or kNoVoxel, and of a voxel where it is and how far squared.
  struct Found {
    VoxelColumn voxel;
    FloatColumns at_m;
    alignas(64) std::array<double, PointColumns::kMost> square_m2{};
  };

  /// For each of the points number points[k], at most PointColumns::kMost, which now are at at_m[k] in the map's frame,
  /// a voxel no farther than `limit_m` (<= the search's max_distance_m): the nearest one, or by the field one that is
  /// not much farther. Many at once wait for memory once, not point by point.
  void near(std::span<const std::uint32_t> points, const PointColumns& at_m, double limit_m, Found& found);

  /// Whether answers are those of NearestVoxelSearch::nearest.
  [[nodiscard]] bool exact() const { return field_ == nullptr; }
  [[nodiscard]] const NearestVoxelSearch& search() const { return cursor_.search(); }
  /// The exact search, for who needs it beside.
  [[nodiscard]] NearestVoxelCursor& cursor() { return cursor_; }

 private:
  void look_up(const PointColumns& at_m, std::size_t count, double limit_m, Found& found) const;

  const NearestVoxelField* field_;
  NearestVoxelCursor cursor_;
  std::vector<std::uint32_t> last_;  // what each point had near it the last time; for the exact search only
};

}  // namespace kilter
