// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "kilter/occupancy/key_numbers.h"
#include "kilter/occupancy/voxel_map.h"

namespace kilter {

/// What hits say of the voxels they fall into: where their mean is, from where they were seen, and when.
///
/// Hits are kept as they come, until there are very many for the voxels they fall into, as of a robot that stands
/// still: then they go into a sum for each voxel. Each voxel's hits are summed in the order in which they came, either
/// way, so that results have the same bits.
class HitSums {
 public:
  static constexpr std::uint32_t kNoOrigin = std::numeric_limits<std::uint32_t>::max();
  static constexpr std::size_t kManyHits = std::size_t{1} << 22;

  struct Hit {
    Eigen::Vector3f point_m;
    std::uint32_t origin = 0;  ///< number of the scan's origin, or kNoOrigin
  };

  /// \param many_hits  from how many on they may be summed
  explicit HitSums(double resolution_m, std::size_t many_hits = kManyHits)
      : resolution_m_(resolution_m), sum_at_(many_hits), many_hits_(many_hits) {}

  void add(const Hit& hit) {
    if (parts_.empty() || parts_.back().size() == parts_.back().capacity()) add_part();
    parts_.back().push_back(hit);
    ++kept_;
  }
  /// At the end of a scan: sums hits up if they are very many for their voxels.
  /// \param origins_m  of all scans so far
  void sum_up_if_many(std::span<const Eigen::Vector3f> origins_m);

  [[nodiscard]] std::size_t held_bytes() const;

  /// Means of the hits inside each occupied voxel, without log-odds; `normals` holds the mean viewing direction for
  /// now, which is what with_surface_normals orients by. O(hits + voxels).
  [[nodiscard]] SurfaceVoxels summarise(std::span<const VoxelBlock> occupied,
                                        std::span<const Eigen::Vector3f> origins_m) const;

 private:
  struct Sum {
    Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d view = Eigen::Vector3d::Zero();
    double time = 0.0;
    std::uint32_t count = 0;

    void add(const Hit& hit, std::span<const Eigen::Vector3f> origins_m);
  };

  void add_part();
  [[nodiscard]] std::uint32_t number_of(const Eigen::Vector3f& point_m);
  [[nodiscard]] bool number_voxels();
  void sum_up(std::span<const Eigen::Vector3f> origins_m);
  [[nodiscard]] std::vector<Sum> sums_of(std::span<const VoxelBlock> occupied,
                                         std::span<const Eigen::Vector3f> origins_m) const;

  double resolution_m_;
  std::size_t sum_at_;  // as soon as there are so many hits
  std::size_t many_hits_;
  // Hits that are not in sums_, in parts that grow with their number and are never moved. Memory that none fills is not
  // touched.
  std::vector<std::vector<Hit>> parts_;
  std::size_t kept_ = 0;   // in all parts
  KeyNumbers blocks_;      // of voxels with sums
  KeyNumbers voxels_;      // block's number, then bit
  std::vector<Sum> sums_;  // by voxel's number
};

}  // namespace kilter
