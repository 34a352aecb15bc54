// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/parallel_gap.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <vector>

#include "kilter/matching/pair_grain.h"

namespace kilter {
namespace {

constexpr double kCell_m = 1.0;
constexpr std::size_t kMostVoxels = 6000;
constexpr float kLeastPlanarity = 0.3F;
constexpr double kSameWay = 0.94;        // cosine between the normals of two voxels of one surface
constexpr double kSameDirection = 0.95;  // and of a direction's surfaces
constexpr double kBesideVoxels = 1.5;    // this far from the normal a voxel may lie
constexpr double kLayerVoxels = 0.5;     // and this far from the nearest one of its layer, along the normal
constexpr std::size_t kFewestVoxels = 5;
constexpr std::size_t kFewestCells = 6;
constexpr double kFloorVoxels = 0.05;  // centroids are no better than this, however many there are
constexpr double kMostSpread = 0.5;    // of the gap; or half a voxel
constexpr double kSignificant = 0.01;
constexpr double kMadToSigma = 1.4826;
constexpr double kMedianToMean = 1.2533;  // standard error of a median against that of a mean

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double spread_about(const std::vector<double>& values, double centre) {
  std::vector<double> off(values.size());
  std::transform(values.begin(), values.end(), off.begin(), [&](double v) { return std::abs(v - centre); });
  return kMadToSigma * median_of(std::move(off));
}

// What the voxels of one direction say, cell by cell. The key sorts cells by z, y, x.
struct Direction {
  Eigen::Vector3d leader = Eigen::Vector3d::Zero();  // normal of the first voxel
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();     // of all normals, turned to its side
  std::map<std::tuple<int, int, int>, std::vector<double>> cells;
};

// Signed distance of a point of the source to the target's nearest layer that faces the same way; positive in front.
std::optional<double> distance_to_layer_m(const VoxelMap& target, const Eigen::Vector3d& at_m,
                                          const Eigen::Vector3d& normal, bool oriented) {
  const double resolution_m = target.resolution_m();
  const double beside_m = kBesideVoxels * resolution_m;
  // The box around what lies along the normal, and a hundredth of a voxel for what floats lose; as far as a voxel may
  // be from that of the point.
  const Eigen::Array3d along_axes = normal.array().abs();
  const Eigen::Array3d reach_m = ParallelGap::kMost_m * along_axes +
                                 beside_m * (1.0 - along_axes.square()).max(0.0).sqrt() +
                                 Eigen::Array3d::Constant(0.01 * resolution_m);
  const VoxelIndex centre = voxel_at(at_m, resolution_m);
  const VoxelIndex farthest = VoxelIndex::Constant(static_cast<int>(std::ceil(ParallelGap::kMost_m / resolution_m)));
  const VoxelIndex low = voxel_at(at_m - reach_m.matrix(), resolution_m).cwiseMax(centre - farthest);
  const VoxelIndex high = voxel_at(at_m + reach_m.matrix(), resolution_m).cwiseMin(centre + farthest);
  std::vector<double> distances_m;
  target.visit_box(low, high, [&](std::uint32_t i) {
    const SurfaceVoxels& voxels = target.voxels();
    const Eigen::Vector3d between_m = at_m - voxels.centroids_m[i].cast<double>();
    const double along_m = between_m.dot(normal);
    if ((between_m - along_m * normal).squaredNorm() > beside_m * beside_m || std::abs(along_m) > ParallelGap::kMost_m)
      return;
    if (voxels.planarity[i] < kLeastPlanarity) return;
    Eigen::Vector3d other = voxels.normals[i].cast<double>();
    if (!oriented && other.dot(normal) < 0.0) other = -other;
    if (other.dot(normal) < kSameWay) return;
    distances_m.push_back(between_m.dot(other));
  });
  if (distances_m.empty()) return std::nullopt;
  const double nearest_m = *std::min_element(distances_m.begin(), distances_m.end(),
                                             [](double a, double b) { return std::abs(a) < std::abs(b); });
  double sum_m = 0.0;
  int count = 0;
  for (const double distance_m : distances_m) {
    if (std::abs(distance_m - nearest_m) > kLayerVoxels * resolution_m) continue;
    sum_m += distance_m;
    ++count;
  }
  return sum_m / count;
}

Direction& direction_of(const Eigen::Vector3d& normal, std::vector<Direction>& directions) {
  const auto found = std::find_if(directions.begin(), directions.end(), [&](const Direction& direction) {
    return std::abs(direction.leader.dot(normal)) >= kSameDirection;
  });
  if (found != directions.end()) return *found;
  directions.emplace_back().leader = normal;
  return directions.back();
}

std::vector<Direction> collect(const VoxelMap& source, const VoxelMap& target, const Pose3& T_target_source) {
  const Eigen::Isometry3d T = T_target_source.isometry();
  const SurfaceVoxels& voxels = source.voxels();
  const std::size_t stride = std::max<std::size_t>(1, voxels.size() / kMostVoxels);
  Eigen::AlignedBox3d box = target.bounds_m();
  box.min().array() -= ParallelGap::kMost_m;
  box.max().array() += ParallelGap::kMost_m;
  const bool oriented = source.has_free_space() && target.has_free_space();
  std::vector<Direction> directions;
  for (std::size_t i = 0; i < voxels.size(); i += stride) {
    if (voxels.planarity[i] < kLeastPlanarity) continue;
    const Eigen::Vector3d at_m = T * voxels.centroids_m[i].cast<double>();
    if (!box.contains(at_m)) continue;
    const Eigen::Vector3d normal = T.linear() * voxels.normals[i].cast<double>();
    const std::optional<double> distance_m = distance_to_layer_m(target, at_m, normal, oriented);
    if (!distance_m) continue;
    Direction& direction = direction_of(normal, directions);
    const Eigen::Vector3i cell = voxel_at(at_m, kCell_m);
    const double side = normal.dot(direction.leader) > 0.0 ? 1.0 : -1.0;
    direction.sum += side * normal;
    direction.cells[{cell.z(), cell.y(), cell.x()}].push_back(side * *distance_m);
  }
  return directions;
}

// Nothing where too few cells show the direction, or they disagree.
std::optional<ParallelGap> gap_along(const Direction& direction, const PairGrain& grain) {
  std::vector<double> values;
  for (const auto& [cell, distances_m] : direction.cells) {
    if (distances_m.size() >= kFewestVoxels) values.push_back(median_of(distances_m));
  }
  if (values.size() < kFewestCells) return std::nullopt;
  const double middle_m = median_of(values);
  const double spread_m = spread_about(values, middle_m);
  if (spread_m > std::max(kMostSpread * std::abs(middle_m), 0.5 * grain.edge_m)) return std::nullopt;
  ParallelGap gap;
  gap.gap_m = std::abs(middle_m);
  const double seen_m =
      std::hypot(kMedianToMean * spread_m / std::sqrt(static_cast<double>(values.size())), kFloorVoxels * grain.edge_m);
  gap.sigma_m = std::hypot(seen_m, grain.sigma_m());
  gap.p_value = std::erfc(gap.gap_m / gap.sigma_m / std::sqrt(2.0));
  gap.normal = direction.sum.normalized();
  gap.cells = values.size();
  return gap;
}

}  // namespace

std::optional<ParallelGap> measure_parallel_gap(const VoxelMap& source, const VoxelMap& target,
                                                const Pose3& T_target_source) {
  std::vector<ParallelGap> gaps;
  const PairGrain grain = grain_of(source, target);
  for (const Direction& direction : collect(source, target, T_target_source)) {
    if (const auto gap = gap_along(direction, grain)) gaps.push_back(*gap);
  }
  for (ParallelGap& gap : gaps) gap.p_value = std::min(1.0, gap.p_value * static_cast<double>(gaps.size()));
  const auto worth = [](const ParallelGap& gap) {
    const bool significant = gap.p_value < kSignificant;
    return std::tuple(significant, significant ? gap.gap_m : static_cast<double>(gap.cells));
  };
  const auto best = std::max_element(gaps.begin(), gaps.end(),
                                     [&](const ParallelGap& a, const ParallelGap& b) { return worth(a) < worth(b); });
  return best == gaps.end() ? std::nullopt : std::optional(*best);
}

}  // namespace kilter
