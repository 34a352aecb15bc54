// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/submap/fuse_submaps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace kilter {
namespace {

using Cell = std::array<std::int64_t, 3>;  // z, y, x: sorts like blocks do

// One voxel of one submap.
struct Contribution {
  Cell cell{};
  float log_odds = 0.0F;
  Eigen::Vector3d centroid_world_m;
};

// What all submaps say of one cell.
struct Sum {
  Cell cell{};
  Eigen::Vector3d centroids_world_m = Eigen::Vector3d::Zero();
  double log_odds = 0.0;  // of the surfaces
  int surfaces = 0;
  int misses = 0;
  int robot = 0;  // of the first surface

  [[nodiscard]] Eigen::Vector3d centroid_world_m() const { return centroids_world_m / surfaces; }
};

struct CellHash {
  std::size_t operator()(const Cell& cell) const {
    std::uint64_t hash = 0;
    for (const std::int64_t axis : cell) hash = (hash ^ static_cast<std::uint64_t>(axis)) * 0x9E3779B97F4A7C15ULL;
    return static_cast<std::size_t>(hash ^ hash >> 32);
  }
};

Cell cell_at(const Eigen::Vector3d& point_m, double resolution_m) {
  const Eigen::Vector3d index = (point_m / resolution_m).array().floor();
  return {std::llround(index.z()), std::llround(index.y()), std::llround(index.x())};
}

double log_odds(double probability) { return std::log(probability / (1.0 - probability)); }

// A submap's voxels by cell, the strongest of each cell first.
std::vector<Contribution> contributions_of(const SubmapNode& node, const VoxelMap& map, double resolution_m) {
  const SurfaceVoxels& voxels = map.voxels();
  std::vector<Contribution> all;
  all.reserve(voxels.size());
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const Eigen::Vector3d at_m = node.T_world_submap * voxels.centroids_m[i].cast<double>();
    all.push_back({cell_at(at_m, resolution_m), voxels.log_odds[i], at_m});
  }
  std::stable_sort(all.begin(), all.end(), [](const Contribution& a, const Contribution& b) {
    return std::tuple(a.cell, -a.log_odds) < std::tuple(b.cell, -b.log_odds);
  });
  return all;
}

// The surfaces of all submaps, each cell summed in the order of the submaps. The table says where a cell's sum is, and
// is never walked through.
class Surfaces {
 public:
  void add(const SubmapNode& node, const VoxelMap& map, double resolution_m) {
    const std::vector<Contribution> contributions = contributions_of(node, map, resolution_m);
    const Contribution* last = nullptr;
    for (const Contribution& one : contributions) {
      if (last != nullptr && one.cell == last->cell) continue;
      last = &one;
      const auto [place, is_new] = places_.try_emplace(one.cell, sums_.size());
      if (is_new) {
        sums_.emplace_back().cell = one.cell;
        sums_.back().robot = node.robot;
      }
      Sum& sum = sums_[place->second];
      sum.log_odds += one.log_odds;  // Eq. (2)-(3)
      sum.centroids_world_m += one.centroid_world_m;
      ++sum.surfaces;
    }
  }

  [[nodiscard]] std::vector<Sum> take_sorted() {
    places_.clear();
    std::sort(sums_.begin(), sums_.end(), [](const Sum& a, const Sum& b) { return a.cell < b.cell; });
    return std::move(sums_);
  }

 private:
  std::unordered_map<Cell, std::size_t, CellHash> places_;
  std::vector<Sum> sums_;
};

// Calls visit(sum) for all cells of a box, leaping over rows and layers outside of it.
template <typename Visit>
void visit_box(std::vector<Sum>& sums, const Cell& low, const Cell& high, const Visit& visit) {
  const auto from = [&](const Cell& cell) {
    return std::lower_bound(sums.begin(), sums.end(), cell, [](const Sum& a, const Cell& b) { return a.cell < b; });
  };
  for (auto sum = from(low); sum != sums.end() && sum->cell[0] <= high[0];) {
    const auto [z, y, x] = sum->cell;
    if (y < low[1]) {
      sum = from({z, low[1], low[2]});
    } else if (y > high[1]) {
      sum = from({z + 1, low[1], low[2]});
    } else if (x < low[2]) {
      sum = from({z, y, low[2]});
    } else if (x > high[2]) {
      sum = from({z, y + 1, low[2]});
    } else {
      visit(*sum++);
    }
  }
}

// The mean of all centroids of a cell may fall beside a submap's own surface there, where it saw through: that is no
// miss of a cell that it put a surface into.
void add_misses(const SubmapNode& node, const VoxelMap& map, double resolution_m, std::vector<Sum>& sums) {
  const Eigen::AlignedBox3d box = moved_box(map.bounds_m(), node.T_world_submap);
  if (box.isEmpty()) return;
  const Pose3 T_submap_world = node.T_world_submap.inverse();
  const std::vector<Contribution> own = contributions_of(node, map, resolution_m);
  auto next_own = own.begin();
  // One cell more than the box: a mean may be rounded over the border of its cell.
  const Eigen::Vector3d margin_m = Eigen::Vector3d::Constant(resolution_m);
  visit_box(sums, cell_at(box.min() - margin_m, resolution_m), cell_at(box.max() + margin_m, resolution_m),
            [&](Sum& sum) {
              while (next_own != own.end() && next_own->cell < sum.cell) ++next_own;
              if (next_own != own.end() && next_own->cell == sum.cell) return;
              const Eigen::Vector3d centroid_world_m = sum.centroid_world_m();
              if (!box.contains(centroid_world_m)) return;
              const VoxelIndex index = voxel_at(T_submap_world * centroid_world_m, map.resolution_m());
              if (map.state(index) == CellState::kFree) ++sum.misses;
            });
}

}  // namespace

Expected<std::vector<FusedVoxel>> fuse_submaps(std::span<const SubmapNode> nodes, const LendMap& lend,
                                               const OccupancyOptions& options) {
  const double miss = log_odds(options.probability_miss);
  const double low = log_odds(options.clamping_min);
  const double high = log_odds(options.clamping_max);
  const double threshold = log_odds(options.occupancy_threshold);
  Surfaces surfaces;
  for (const SubmapNode& node : nodes) {
    const auto done = lend(node.id, [&](const VoxelMap& map) { surfaces.add(node, map, options.resolution_m); });
    if (!done) return pass_up(done.error());
  }
  std::vector<Sum> sums = surfaces.take_sorted();
  for (const SubmapNode& node : nodes) {
    const auto done = lend(node.id, [&](const VoxelMap& map) { add_misses(node, map, options.resolution_m, sums); });
    if (!done) return pass_up(done.error());
  }
  std::vector<FusedVoxel> fused;
  for (const Sum& sum : sums) {
    double value = sum.log_odds;
    for (int k = 0; k < sum.misses; ++k) value += miss;
    value = std::clamp(value, low, high);
    if (value >= threshold) fused.push_back({sum.centroid_world_m(), value, sum.robot});
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
