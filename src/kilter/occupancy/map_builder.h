// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/base/vector_path.h"
#include "kilter/geometry/pose3.h"
#include "kilter/occupancy/block_store.h"
#include "kilter/occupancy/hit_sums.h"
#include "kilter/occupancy/occupancy_options.h"
#include "kilter/occupancy/scan_marks.h"
#include "kilter/occupancy/trace_rays.h"
#include "kilter/occupancy/voxel_map.h"

namespace kilter {

/// Integrates scans into one occupancy map by tracing every ray. In each scan a voxel is updated once: as a hit if any
/// ray ends in it, else as a miss if any ray passes it. The map is that of OctoMap's insertPointCloud to the last bit:
/// its rounding (points, origins and directions are floats), its traversal, its clamping. Not thread-safe.
class MapBuilder {
 public:
  /// Asked now and then while rays are traced, with what the builder holds; false ends it.
  using KeepGoing = std::function<bool(std::size_t held_bytes)>;

  explicit MapBuilder(const OccupancyOptions& options);
  /// With the instructions of a narrower path than the processor's widest; the map is the same.
  MapBuilder(const OccupancyOptions& options, VectorPath path);

  /// Adds one scan. Both in the map's frame, rounded to float. [m] A point at the origin is no return. What lies off
  /// the lattice is left out and counted; all of a scan whose origin does. O(points * range / resolution).
  /// \return false if `keep_going` said so, or the scan alone is too much (too_much_of_a_scan): it is then in it in
  /// part, and the builder good for nothing.
  bool insert_scan(std::span<const Eigen::Vector3d> points_m, const Eigen::Vector3d& origin_m,
                   const KeepGoing& keep_going = {});

  /// Adds points without a sensor origin: one hit for each voxel, nothing becomes free. What lies off
  /// the lattice is left out and counted.
  /// \return as insert_scan.
  bool insert_points(std::span<const Eigen::Vector3d> points_m, const KeepGoing& keep_going = {});

  /// The same of clouds in their own frames, a scan's being its sensor's. Points are moved some at a time, so that no
  /// copy of them all is made; before they are taken, `keep_going` is asked with what they will take besides.
  bool insert_scan(std::span<const Eigen::Vector3f> points_m, const Pose3& T_map_scan, const KeepGoing& keep_going);
  bool insert_points(std::span<const Eigen::Vector3f> points_m, const Pose3& T_map_cloud, const KeepGoing& keep_going);

  /// Points that were left out so far because they, or their scan's origin, lie off the lattice.
  [[nodiscard]] std::size_t points_off_lattice() const { return points_off_lattice_; }

  /// The finished map with centroids and normals; the builder is empty afterwards.
  [[nodiscard]] VoxelMap finish();

 private:
  void take_returns(std::span<const Eigen::Vector3d> points_m, const Eigen::Vector3f& origin_m);
  void take_points(std::span<const Eigen::Vector3d> points_m);
  [[nodiscard]] bool begin_scan(const Eigen::Vector3d& origin_m, std::size_t points);
  [[nodiscard]] bool finish_scan(const KeepGoing& keep_going);
  [[nodiscard]] bool finish_points(const KeepGoing& keep_going);
  [[nodiscard]] std::size_t held_bytes() const;
  template <typename Mark>
  [[nodiscard]] bool mark_in_parts(std::size_t count, std::size_t at_once, const KeepGoing& keep_going,
                                   const Mark& mark);
  [[nodiscard]] bool mark_hits(std::size_t count, const KeepGoing& keep_going);
  [[nodiscard]] bool trace(const Eigen::Vector3f& from_m, const KeepGoing& keep_going);
  void open_window(const Eigen::AlignedBox3f& box_m);
  [[nodiscard]] RayKernels kernels() const;
  void apply_marks();

  OccupancyOptions options_;
  bool has_free_space_ = false;
  std::size_t points_off_lattice_ = 0;
  RayKernels kernels_;
  ScanMarks marks_;
  BlockStore blocks_;
  RayEnds ends_m_;    // of a scan: its hits, then rays that go on beyond the range
  RayEnds beyond_m_;  // the latter alone
  RayEnds some_ends_m_;
  HitSums hits_;
  std::vector<Eigen::Vector3f> origins_m_;
};

/// That a scan, or a cloud of points alone, touches more of the map than can be marked at once. \param where  its file.
[[nodiscard]] Error too_much_of_a_scan(std::string where);

}  // namespace kilter
