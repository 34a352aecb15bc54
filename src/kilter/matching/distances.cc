// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/distances.h"

#include <algorithm>
#include <cmath>
#include <numeric>

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

// Blocks with voxels that may lie in a box of the frame that T leads to.
std::vector<const VoxelBlock*> blocks_that_reach(const VoxelMap& map, const Eigen::Isometry3d& T,
                                                 const Eigen::AlignedBox3d& box) {
  const double half_m = 0.5 * kBlockSize * map.resolution_m();
  const double reach_m = 1.001 * std::sqrt(3.0) * half_m;
  std::vector<const VoxelBlock*> blocks;
  for (const VoxelBlock& block : map.blocks()) {
    if (block.voxel_count == 0) continue;
    const Eigen::Vector3d middle_m =
        T * Eigen::Vector3d(2.0 * half_m * (block_of_key(block.key).cast<double>().array() + 0.5));
    if (box.squaredExteriorDistance(middle_m) <= reach_m * reach_m) blocks.push_back(&block);
  }
  return blocks;
}

// One sample from each of as many equal parts, at places in them that repeat in no rhythm (of the golden ratio), or
// they would beat against the rows of the lattice.
std::size_t place_of_sample(std::size_t k, std::size_t samples, std::size_t voxels) {
  constexpr double kGolden = 0.6180339887498949;
  const double within = std::fmod(kGolden * static_cast<double>(k), 1.0);
  const double place = (static_cast<double>(k) + within) * static_cast<double>(voxels) / static_cast<double>(samples);
  return std::min(static_cast<std::size_t>(place), voxels - 1);
}

// The mean of which so few would be counted in one of a thousand cases (Poisson's law, within a few per cent).
double largest_mean(double counted) { return counted + 3.1 * std::sqrt(counted + 1.0) + 4.0; }

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
  if (target.map().voxels().size() == 0) return {};
  const Eigen::AlignedBox3d box = widened_box(target.map(), options.max_distance_m);
  const Eigen::Isometry3d T = T_target_source.isometry();
  const std::vector<const VoxelBlock*> blocks = blocks_that_reach(source, T, box);
  const std::size_t voxels =
      std::accumulate(blocks.begin(), blocks.end(), std::size_t{0},
                      [](std::size_t sum, const auto* block) { return sum + block->voxel_count; });
  const std::size_t samples = std::min(voxels, max_samples);
  double candidates = 0.0;
  double matched = 0.0;
  auto block = blocks.begin();
  std::size_t before = 0;  // voxels of the blocks that came before
  for (std::size_t k = 0; k < samples; ++k) {
    const std::size_t place = samples == voxels ? k : place_of_sample(k, samples, voxels);
    for (; place >= before + (*block)->voxel_count; ++block) before += (*block)->voxel_count;
    const std::size_t voxel = (*block)->first_voxel + (place - before);
    const Eigen::Vector3d at_m = T * voxel_position_m(source, voxel, options.position);
    if (!box.contains(at_m)) continue;
    candidates += 1.0;
    if (target.nearest(at_m, options.max_distance_m)) matched += 1.0;
  }
  if (candidates == 0.0 && samples == voxels) return {};
  const double each = static_cast<double>(voxels) / static_cast<double>(samples);
  const double at_most = samples == voxels ? matched : largest_mean(matched);
  return {matched * each, candidates > 0.0 ? matched / candidates : 0.0, at_most * each,
          candidates > 0.0 ? std::min(at_most / candidates, 1.0) : 1.0};
}

}  // namespace kilter
