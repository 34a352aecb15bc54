// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/distances.h"

#include <algorithm>
#include <cmath>

#include "kilter/matching/nearest_of_all.h"

namespace kilter {

std::vector<OptionField> fields(MatchingOptions& o) {
  return {
      real_option("d", o.max_distance_m, Unit::kMetre, 0.01, 100.0,
                  "Maximum search distance: voxels farther apart do not match.", "d"),
      real_option("occupancy_weight_m", o.occupancy_weight_m, Unit::kMetre, 0.0, 10.0,
                  "Metres that a difference of 1 in occupancy probability adds to a distance.", "d_f"),
      choice_option("voxel_position", o.position, {"centre", "centroid"},
                    "Point that stands for a voxel in the paper's distances."),
      real_option(
          "overlap_min", o.overlap_min, Unit::kRatio, 0.0, 1.0,
          "Matched fraction of the voxels inside the other submap's box, in the better direction, below which a pair "
          "is left alone, unless it would overlap as much moved by what odometry may have drifted."),
      count_option(
          "matched_min", o.matched_min, 2, 1000000000,
          "Matched voxels, of the submap that has fewer, below which a pair is left alone, as with `overlap_min`."),
  };
}

namespace {

Eigen::AlignedBox3d widened_box(const VoxelMap& map, double by_m) {
  Eigen::AlignedBox3d box = map.bounds_m();
  box.min().array() -= by_m;
  box.max().array() += by_m;
  return box;
}

}  // namespace

DistanceSample measure_distances(const NearestVoxelSearch& source, const NearestVoxelSearch& target,
                                 const Pose3& T_target_source, const MatchingOptions& options) {
  DistanceSample sample;
  const VoxelMap& from = source.map();
  const VoxelMap& onto = target.map();
  if (from.voxels().size() == 0 || onto.voxels().size() == 0) return sample;
  const double d = options.max_distance_m;
  const Eigen::AlignedBox3d box = widened_box(onto, d);
  const Eigen::Isometry3d T = T_target_source.isometry();
  const std::vector<NearestVoxel> nearest = nearest_of_all(source, target, T_target_source, d);
  double euclidean_sum = 0.0;
  double occupancy_sum = 0.0;
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    if (!box.contains(T * voxel_position_m(from, i, source.position()))) continue;
    ++sample.candidates;
    if (nearest[i].voxel == kNoVoxel) continue;
    const double occupancy_m =
        options.occupancy_weight_m * std::abs(from.probability(i) - onto.probability(nearest[i].voxel));
    const double distance_m = nearest[i].distance_m + occupancy_m;  // Eq. (8)
    if (distance_m > d) continue;
    sample.distances_m.push_back(distance_m);
    euclidean_sum += nearest[i].distance_m;
    occupancy_sum += occupancy_m;
  }
  if (sample.matched() > 0) {
    sample.mean_euclidean_m = euclidean_sum / static_cast<double>(sample.matched());
    sample.mean_occupancy_m = occupancy_sum / static_cast<double>(sample.matched());
  }
  return sample;
}

OverlapEstimate estimate_overlap(const VoxelMap& source, NearestVoxelCursor& target, const Pose3& T_target_source,
                                 const MatchingOptions& options, std::size_t max_samples) {
  const std::size_t count = source.voxels().size();
  if (count == 0 || target.map().voxels().size() == 0) return {};
  const std::size_t stride = std::max<std::size_t>(1, count / max_samples);
  const Eigen::AlignedBox3d box = widened_box(target.map(), options.max_distance_m);
  const Eigen::Isometry3d T = T_target_source.isometry();
  std::size_t candidates = 0;
  std::size_t matched = 0;
  for (std::size_t i = 0; i < count; i += stride) {
    const Eigen::Vector3d at_m = T * voxel_position_m(source, i, options.position);
    if (!box.contains(at_m)) continue;
    ++candidates;
    if (target.nearest(at_m, options.max_distance_m)) ++matched;
  }
  if (candidates == 0) return {};
  return {static_cast<double>(matched * stride), static_cast<double>(matched) / static_cast<double>(candidates)};
}

}  // namespace kilter
