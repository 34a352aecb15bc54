// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/submap/fuse_submaps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <tuple>

namespace kilter {
namespace {

using Cell = std::array<std::int64_t, 3>;  // z, y, x: sorts like blocks do

struct Contribution {
  Cell cell;
  std::int32_t submap;  // position in the caller's list
  float log_odds;
  Eigen::Vector3d centroid_world_m;
};

Cell cell_at(const Eigen::Vector3d& point_m, double resolution_m) {
  const Eigen::Vector3d index = (point_m / resolution_m).array().floor();
  return {std::llround(index.z()), std::llround(index.y()), std::llround(index.x())};
}

double log_odds(double probability) { return std::log(probability / (1.0 - probability)); }

// Every voxel of every submap, the strongest of each (cell, submap) first.
std::vector<Contribution> gather(std::span<const Submap* const> submaps, double resolution_m) {
  std::vector<Contribution> all;
  for (std::size_t s = 0; s < submaps.size(); ++s) {
    const SurfaceVoxels& voxels = submaps[s]->map.voxels();
    for (std::size_t i = 0; i < voxels.size(); ++i) {
      const Eigen::Vector3d at_m = submaps[s]->T_world_submap * voxels.centroids_m[i].cast<double>();
      all.push_back({cell_at(at_m, resolution_m), static_cast<std::int32_t>(s), voxels.log_odds[i], at_m});
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const Contribution& a, const Contribution& b) {
    return std::tuple(a.cell, a.submap, -a.log_odds) < std::tuple(b.cell, b.submap, -b.log_odds);
  });
  return all;
}

}  // namespace

std::vector<FusedVoxel> fuse_submaps(std::span<const Submap* const> submaps, const OccupancyOptions& options) {
  const double miss = log_odds(options.probability_miss);
  const double low = log_odds(options.clamping_min);
  const double high = log_odds(options.clamping_max);
  const double threshold = log_odds(options.occupancy_threshold);
  std::vector<Pose3> T_submap_world;
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const Submap* submap : submaps) {
    T_submap_world.push_back(submap->T_world_submap.inverse());
    boxes.push_back(submap->bounds_world_m());
  }
  const std::vector<Contribution> all = gather(submaps, options.resolution_m);
  std::vector<FusedVoxel> fused;
  for (std::size_t begin = 0; begin < all.size();) {
    std::size_t end = begin;
    FusedVoxel voxel{Eigen::Vector3d::Zero(), 0.0, submaps[static_cast<std::size_t>(all[begin].submap)]->robot};
    int surfaces = 0;
    std::int32_t last = -1;
    for (; end < all.size() && all[end].cell == all[begin].cell; ++end) {
      if (all[end].submap == last) continue;
      last = all[end].submap;
      voxel.log_odds += all[end].log_odds;
      voxel.centroid_world_m += all[end].centroid_world_m;
      ++surfaces;
    }
    voxel.centroid_world_m /= surfaces;
    for (std::size_t s = 0; s < submaps.size(); ++s) {
      if (!boxes[s].contains(voxel.centroid_world_m)) continue;
      const Eigen::Vector3d at_m = T_submap_world[s] * voxel.centroid_world_m;
      const VoxelIndex index = voxel_at(at_m, submaps[s]->map.resolution_m());
      if (submaps[s]->map.state(index) == CellState::kFree) voxel.log_odds += miss;
    }
    voxel.log_odds = std::clamp(voxel.log_odds, low, high);
    if (voxel.log_odds >= threshold) fused.push_back(voxel);
    begin = end;
  }
  return fused;
}

Expected<OccupancyCells> cells_from_fused(std::span<const FusedVoxel> voxels, double resolution_m) {
  OccupancyCells known{resolution_m, {}};
  known.cells.reserve(voxels.size());
  for (const FusedVoxel& voxel : voxels) {
    // Beyond 16 bits anyway where the cast would not be defined.
    const Eigen::Vector3d index = (voxel.centroid_world_m / resolution_m).cwiseMin(1e9).cwiseMax(-1e9);
    const Expected<OccupancyCell> cell =
        cell_of_voxel(index.array().floor().matrix().cast<int>(), resolution_m, static_cast<float>(voxel.log_odds));
    if (!cell) return pass_up(cell.error());
    known.cells.push_back(*cell);
  }
  return known;
}

}  // namespace kilter
