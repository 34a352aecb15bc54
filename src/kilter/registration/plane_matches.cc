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

struct Strides {
  std::size_t source = 1;
  std::size_t target = 1;
};

// Both ways, so that it does not matter which of the two is called the source. A target point q lies off a source
// plane by (R n) . (q - T c); moving the source moves that plane, hence the turned direction.
// \return how many voxels the residuals stand for.
std::size_t match_both_ways(PlanePair& pair, const Pose3& T_target_source, double search_m, const Strides& strides,
                            std::vector<PlaneResidual>& residuals, const MotionOfPlace& shift = {}) {
  residuals.clear();
  residuals.reserve(pair.source_map().voxels().size() / strides.source +
                    pair.target_map().voxels().size() / strides.target + 2);
  match_voxels(pair.source_map(), every(strides.source, pair.source_map().voxels().size()), pair.in_target,
               T_target_source, search_m, residuals, shift);
  const Eigen::Isometry3d T = T_target_source.isometry();
  MotionOfPlace back;
  if (shift) {
    back = [&](const Eigen::Vector3d& at_m, std::uint8_t from_at, std::uint8_t onto_at) -> Eigen::Vector3d {
      return -(T.linear().transpose() * shift(T * at_m, onto_at, from_at));
    };
  }
  const std::size_t forward = residuals.size();
  match_voxels(pair.target_map(), every(strides.target, pair.target_map().voxels().size()), pair.in_source,
               T_target_source.inverse(), search_m, residuals, back);
  for (std::size_t i = forward; i < residuals.size(); ++i) {
    residuals[i].point_m = T * residuals[i].point_m;
    residuals[i].direction = -(T.linear() * residuals[i].direction);
    std::swap(residuals[i].source_at, residuals[i].target_at);
  }
  return forward * strides.source + (residuals.size() - forward) * strides.target;
}

Strides strides_of(const PlanePair& pair, std::size_t max_points) {
  const auto stride = [&](const VoxelMap& of) { return std::max<std::size_t>(1, of.voxels().size() / max_points); };
  return {stride(pair.source_map()), stride(pair.target_map())};
}

// Some voxels of one submap, and the planes of the other that they meet.
struct Batch {
  std::size_t count = 0;
  FloatColumns centroid_m;  // of the voxels, in their own frame
  FloatColumns normal;
  PointColumns at_m;  // the centroids in the planes' frame
  RepeatedSearch::Found near;
  FloatColumns plane_normal;  // zero where there is none
  alignas(64) std::array<double, PointColumns::kMost> residual_m{};
  alignas(64) std::array<double, PointColumns::kMost> agreement{};  // of the normals: a cosine; 1 where one is unknown
};

// normals_agree() as a number, and what the matches are off.
[[gnu::always_inline]] inline void compare_all(const Transform& T, bool oriented, Batch& batch) {
  const double of_sign = oriented ? 0.0 : 1.0;
  for (std::size_t k = 0; k < batch.count; ++k) {
    const double x = batch.normal.x[k];
    const double y = batch.normal.y[k];
    const double z = batch.normal.z[k];
    const double plane_x = batch.plane_normal.x[k];
    const double plane_y = batch.plane_normal.y[k];
    const double plane_z = batch.plane_normal.z[k];
    const double cosine = (T.turn[0][0] * x + T.turn[0][1] * y + T.turn[0][2] * z) * plane_x +
                          (T.turn[1][0] * x + T.turn[1][1] * y + T.turn[1][2] * z) * plane_y +
                          (T.turn[2][0] * x + T.turn[2][1] * y + T.turn[2][2] * z) * plane_z;
    const double either = std::abs(cosine) * of_sign;
    const double agreement = cosine > either ? cosine : either;
    const double known = x * x + y * y + z * z > 0.0 ? agreement : 1.0;
    batch.agreement[k] = plane_x * plane_x + plane_y * plane_y + plane_z * plane_z > 0.0 ? known : -1.0;
    batch.residual_m[k] =
        plane_x * (batch.at_m.x[k] - batch.near.at_m.x[k]) +
        (plane_y * (batch.at_m.y[k] - batch.near.at_m.y[k]) + plane_z * (batch.at_m.z[k] - batch.near.at_m.z[k]));
  }
}

using Compare = void (*)(const Transform& T, bool oriented, Batch& batch);

void compare_baseline(const Transform& T, bool oriented, Batch& batch) { compare_all(T, oriented, batch); }

#if defined(__x86_64__)
[[gnu::target("avx2")]] void compare_avx2(const Transform& T, bool oriented, Batch& batch) {
  compare_all(T, oriented, batch);
}
[[gnu::target("avx512f")]] void compare_avx512(const Transform& T, bool oriented, Batch& batch) {
  compare_all(T, oriented, batch);
}
#endif

Compare compare_with(VectorPath path) {
#if defined(__x86_64__)
  if (path == VectorPath::kAvx512) return compare_avx512;
  if (path == VectorPath::kAvx2) return compare_avx2;
#else
  static_cast<void>(path);
#endif
  return compare_baseline;
}

void take_voxels(const SurfaceVoxels& points, std::span<const std::uint32_t> voxels, Batch& batch) {
  batch.count = voxels.size();
  for (std::size_t k = 0; k < voxels.size(); ++k) {
    batch.centroid_m.set(k, points.centroids_m[voxels[k]]);
    batch.normal.set(k, points.normals[voxels[k]]);
  }
}

// The median of no negative numbers: of the bin that holds it, those in it are put in order.
double median_of_sizes(std::vector<double>& sizes) {
  constexpr std::size_t kBins = 4096;
  const double largest = *std::max_element(sizes.begin(), sizes.end());
  const double per_bin = largest > 0.0 ? kBins / largest : 0.0;
  const auto bin_of = [&](double size) { return std::min(static_cast<std::size_t>(size * per_bin), kBins - 1); };
  std::array<std::uint32_t, kBins> counts{};
  for (const double size : sizes) ++counts[bin_of(size)];
  std::size_t rank = sizes.size() / 2;
  std::size_t bin = 0;
  for (; rank >= counts[bin]; ++bin) rank -= counts[bin];
  const auto end = std::remove_if(sizes.begin(), sizes.end(), [&](double size) { return bin_of(size) != bin; });
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(sizes.begin(), middle, end);
  return *middle;
}

double median_absolute_m(const std::vector<PlaneResidual>& residuals) {
  std::vector<double> sizes_m(residuals.size());
  std::transform(residuals.begin(), residuals.end(), sizes_m.begin(),
                 [](const PlaneResidual& r) { return std::abs(r.residual_m); });
  return median_of_sizes(sizes_m);
}

}  // namespace

void match_voxels(const VoxelMap& from, std::span<const std::uint32_t> voxels, RepeatedSearch& in_onto,
                  const Pose3& T_onto_from, double search_m, std::vector<PlaneResidual>& residuals,
                  const MotionOfPlace& shift) {
  const VoxelMap& onto = in_onto.search().map();
  const SurfaceVoxels& points = from.voxels();
  const SurfaceVoxels& planes = onto.voxels();
  const bool oriented = from.has_free_space() && onto.has_free_space();
  const Transform T(T_onto_from.isometry());
  const Compare compare = compare_with(in_onto.search().path());
  const LookUpKernels& kernels = look_up_kernels(in_onto.search().path());
  Batch batch;
  for (std::size_t first = 0; first < voxels.size(); first += PointColumns::kMost) {
    const auto numbers = voxels.subspan(first, std::min(PointColumns::kMost, voxels.size() - first));
    take_voxels(points, numbers, batch);
    kernels.move(T, batch.centroid_m, batch.count, batch.at_m);
    in_onto.near(numbers, batch.at_m, shift ? in_onto.search().max_distance_m() : search_m, batch.near);
    if (shift) {
      PointColumns moved_m = batch.at_m;
      for (std::size_t k = 0; k < batch.count; ++k) {
        const std::uint32_t met = batch.near.voxel[k];
        if (met == kNoVoxel) continue;
        moved_m.set(k, moved_m[k] + shift(moved_m[k], points.seen_at[numbers[k]], planes.seen_at[met]));
      }
      in_onto.near(numbers, moved_m, search_m, batch.near);
    }
    for (std::size_t k = 0; k < batch.count; ++k) {
      const std::uint32_t plane = batch.near.voxel[k];
      if (plane == kNoVoxel) continue;
      __builtin_prefetch(planes.planarity.data() + plane);
      __builtin_prefetch(planes.seen_at.data() + plane);
    }
    kernels.take_rows(planes.normals.data(), batch.near.voxel, batch.count, batch.plane_normal);
    compare(T, oriented, batch);
    for (std::size_t k = 0; k < batch.count; ++k) {
      if (batch.agreement[k] < kLeastAgreement) continue;
      const std::uint32_t plane = batch.near.voxel[k];
      residuals.push_back({batch.at_m[k], batch.plane_normal[k].cast<double>(), batch.residual_m[k],
                           static_cast<double>(planes.planarity[plane]), points.seen_at[numbers[k]],
                           planes.seen_at[plane]});
    }
  }
}

std::vector<PlaneResidual> match_planes(PlanePair& pair, const Pose3& T_target_source, double search_m,
                                        std::size_t max_points, const MotionOfPlace& shift) {
  std::vector<PlaneResidual> residuals;
  match_both_ways(pair, T_target_source, search_m, strides_of(pair, max_points), residuals, shift);
  return residuals;
}

std::size_t match_planes(PlanePair& pair, const Pose3& T_target_source, double search_m, std::size_t max_points,
                         std::vector<PlaneResidual>& residuals) {
  return match_both_ways(pair, T_target_source, search_m, strides_of(pair, max_points), residuals);
}

std::vector<PlaneResidual> match_every(PlanePair& pair, const Pose3& T_target_source, double search_m,
                                       std::size_t stride) {
  std::vector<PlaneResidual> residuals;
  match_both_ways(pair, T_target_source, search_m, {stride, stride}, residuals);
  return residuals;
}

void apply_kernel(std::vector<PlaneResidual>& residuals, double least_m) {
  const double scale_m = std::max(2.0 * 1.4826 * median_absolute_m(residuals), least_m);
  for (PlaneResidual& r : residuals) r.weight *= geman_mcclure(r.residual_m, scale_m);
}

}  // namespace kilter
