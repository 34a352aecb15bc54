// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/plane_matches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "kilter/matching/same_side.h"

namespace kilter {
namespace {

std::vector<std::uint32_t> every(std::size_t stride, std::size_t count) {
  std::vector<std::uint32_t> numbers((count + stride - 1) / stride);
  for (std::size_t k = 0; k < numbers.size(); ++k) numbers[k] = static_cast<std::uint32_t>(k * stride);
  return numbers;
}

// Both ways, so that it does not matter which of the two is called the source. A target point q lies off a source
// plane by (R n) . (q - T c); moving the source moves that plane, hence the turned direction.
struct Strides {
  std::size_t source = 1;
  std::size_t target = 1;
};

std::vector<PlaneResidual> match_both_ways(PlanePair& pair, const Pose3& T_target_source, double search_m,
                                           const Strides& strides) {
  std::vector<PlaneResidual> residuals;
  residuals.reserve(pair.source_map().voxels().size() / strides.source +
                    pair.target_map().voxels().size() / strides.target + 2);
  match_voxels(pair.source_map(), every(strides.source, pair.source_map().voxels().size()), pair.in_target,
               T_target_source, search_m, residuals);
  const std::size_t forward = residuals.size();
  match_voxels(pair.target_map(), every(strides.target, pair.target_map().voxels().size()), pair.in_source,
               T_target_source.inverse(), search_m, residuals);
  const Eigen::Isometry3d T = T_target_source.isometry();
  for (std::size_t i = forward; i < residuals.size(); ++i) {
    residuals[i].point_m = T * residuals[i].point_m;
    residuals[i].direction = -(T.linear() * residuals[i].direction);
    std::swap(residuals[i].source_at, residuals[i].target_at);
  }
  return residuals;
}

double median_absolute_m(const std::vector<PlaneResidual>& residuals) {
  std::vector<double> sizes(residuals.size());
  std::transform(residuals.begin(), residuals.end(), sizes.begin(),
                 [](const PlaneResidual& r) { return std::abs(r.residual_m); });
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return *middle;
}

}  // namespace

void match_voxels(const VoxelMap& from, std::span<const std::uint32_t> voxels, RepeatedSearch& in_onto,
                  const Pose3& T_onto_from, double search_m, std::vector<PlaneResidual>& residuals) {
  const VoxelMap& onto = in_onto.search().map();
  const SurfaceVoxels& points = from.voxels();
  const SurfaceVoxels& planes = onto.voxels();
  const bool oriented = from.has_free_space() && onto.has_free_space();
  const Eigen::Isometry3d T = T_onto_from.isometry();
  constexpr std::size_t kBatch = 64;
  std::array<Eigen::Vector3d, kBatch> at_m;
  std::array<NearestVoxel, kBatch> near;
  for (std::size_t first = 0; first < voxels.size(); first += kBatch) {
    const auto batch = voxels.subspan(first, std::min(kBatch, voxels.size() - first));
    for (std::size_t k = 0; k < batch.size(); ++k) at_m[k] = T * points.centroids_m[batch[k]].cast<double>();
    in_onto.near(batch, std::span(at_m).first(batch.size()), search_m, near);
    for (std::size_t k = 0; k < batch.size(); ++k) {
      const std::uint32_t i = batch[k];
      const std::uint32_t plane = near[k].voxel;
      if (plane == kNoVoxel) continue;
      const Eigen::Vector3d normal = planes.normals[plane].cast<double>();
      if (normal.isZero()) continue;
      if (!normals_agree(T.linear() * points.normals[i].cast<double>(), normal, oriented)) continue;
      const double residual_m = normal.dot(at_m[k] - planes.centroids_m[plane].cast<double>());
      residuals.push_back({at_m[k], normal, residual_m, static_cast<double>(planes.planarity[plane]), points.seen_at[i],
                           planes.seen_at[plane]});
    }
  }
}

std::vector<PlaneResidual> match_planes(PlanePair& pair, const Pose3& T_target_source, double search_m,
                                        std::size_t max_points) {
  const auto stride = [&](const VoxelMap& of) { return std::max<std::size_t>(1, of.voxels().size() / max_points); };
  return match_both_ways(pair, T_target_source, search_m, {stride(pair.source_map()), stride(pair.target_map())});
}

std::vector<PlaneResidual> match_every(PlanePair& pair, const Pose3& T_target_source, double search_m,
                                       std::size_t stride) {
  return match_both_ways(pair, T_target_source, search_m, {stride, stride});
}

double geman_mcclure(double residual_m, double scale_m) {
  const double ratio = scale_m * scale_m / (scale_m * scale_m + residual_m * residual_m);
  return ratio * ratio;
}

void apply_kernel(std::vector<PlaneResidual>& residuals, double least_m) {
  const double scale_m = std::max(2.0 * 1.4826 * median_absolute_m(residuals), least_m);
  for (PlaneResidual& r : residuals) r.weight *= geman_mcclure(r.residual_m, scale_m);
}

}  // namespace kilter
