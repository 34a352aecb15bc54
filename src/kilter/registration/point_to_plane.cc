// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/point_to_plane.h"

#include <algorithm>
#include <cmath>

#include "kilter/registration/normal_equations.h"

namespace kilter {
namespace {

constexpr double kShrink = 0.8;            // search distance, from one iteration to the next
constexpr double kFinalSearchVoxels = 4.0; // and where that ends
constexpr double kLeastAgreement = 0.6;    // cosine between normals of matched voxels
constexpr double kSmallStep_m = 2e-4;
constexpr double kSmallTurn_rad = 2e-5;
constexpr double kCell_m = 1.0;            // residuals of one cell are one observation

struct Kernel {
  double scale_m;

  // Geman-McClure: residuals far beyond the scale stop pulling.
  [[nodiscard]] double weight(double residual_m) const {
    const double ratio = scale_m * scale_m / (scale_m * scale_m + residual_m * residual_m);
    return ratio * ratio;
  }
};

// Normals point towards the sensor where there was one; points alone leave the sign open.
bool normals_agree(const Eigen::Vector3d& a, const Eigen::Vector3d& b, bool oriented) {
  if (a.isZero()) return true;
  const double cosine = a.dot(b);
  return (oriented ? cosine : std::abs(cosine)) >= kLeastAgreement;
}

std::vector<PlaneResidual> match_planes(const NearestVoxelSearch& source, const NearestVoxelSearch& target,
                                        const Pose3& T_target_source, double search_m, std::size_t stride) {
  const SurfaceVoxels& from = source.map().voxels();
  const SurfaceVoxels& onto = target.map().voxels();
  const bool oriented = source.map().has_free_space() && target.map().has_free_space();
  const Eigen::Isometry3d T = T_target_source.isometry();
  std::vector<PlaneResidual> residuals;
  residuals.reserve(from.size() / stride + 1);
  for (std::size_t i = 0; i < from.size(); i += stride) {
    const Eigen::Vector3d point_m = T * from.centroids_m[i].cast<double>();
    const std::optional<NearestVoxel> nearest = target.nearest(point_m, search_m);
    if (!nearest) continue;
    const Eigen::Vector3d normal = onto.normals[nearest->voxel].cast<double>();
    if (normal.isZero()) continue;
    if (!normals_agree(T.linear() * from.normals[i].cast<double>(), normal, oriented)) continue;
    const double residual_m = normal.dot(point_m - onto.centroids_m[nearest->voxel].cast<double>());
    residuals.push_back({point_m, normal, residual_m, static_cast<double>(onto.planarity[nearest->voxel])});
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

// Robust weights on top of planarity; the scale follows the residuals' own spread.
void apply_kernel(std::vector<PlaneResidual>& residuals, double resolution_m) {
  const Kernel kernel{std::max(2.0 * 1.4826 * median_absolute_m(residuals), 0.25 * resolution_m)};
  for (PlaneResidual& r : residuals) r.weight *= kernel.weight(r.residual_m);
}

bool out_of_range(const Pose3& start, const Pose3& now, const Eigen::Vector3d& centre_target_m,
                  const RegistrationOptions& options, const RegistrationPrior& prior) {
  const Pose3 moved = now * start.inverse();
  const double shift_m = (moved * centre_target_m - centre_target_m).norm();
  return shift_m > prior.translation_m + options.search_distance_m || moved.angle_rad() > options.max_rotation_rad;
}

}  // namespace

RegistrationResult align_point_to_plane(const NearestVoxelSearch& source, const NearestVoxelSearch& target,
                                        const Pose3& start, const RegistrationOptions& options,
                                        const RegistrationPrior& prior) {
  RegistrationResult result;
  result.T_target_source = start;
  const std::size_t voxels = source.map().voxels().size();
  const std::size_t stride = std::max<std::size_t>(1, voxels / static_cast<std::size_t>(options.max_points));
  const double resolution_m = target.map().resolution_m();
  const auto enough = [&](std::size_t count) {
    return count * stride >= static_cast<std::size_t>(options.min_matches) && count >= 20;
  };
  const double final_search_m = std::min(kFinalSearchVoxels * resolution_m, options.search_distance_m);
  double search_m = options.search_distance_m;
  Pose3 T = start;
  bool settled = false;
  while (!settled && result.iterations < options.max_iterations) {
    ++result.iterations;
    std::vector<PlaneResidual> residuals = match_planes(source, target, T, search_m, stride);
    if (!enough(residuals.size())) return result;
    apply_kernel(residuals, resolution_m);
    const NormalEquations equations = build_normal_equations(residuals);
    const ObservableSplit split = split_observable(equations);
    if (split.unobservable == 6) {
      result.stop = StopReason::kDegenerate;
      return result;
    }
    const Vector6 step = solve_observable(equations, split);
    T = motion_about(equations.centre_m, step) * T;
    if (out_of_range(start, T, equations.centre_m, options, prior)) {
      result.stop = StopReason::kOutOfRange;
      return result;
    }
    const bool small = step.head<3>().norm() < kSmallStep_m && step.tail<3>().norm() < kSmallTurn_rad;
    settled = small && search_m <= final_search_m;
    search_m = std::max(search_m * kShrink, final_search_m);
  }

  std::vector<PlaneResidual> residuals = match_planes(source, target, T, final_search_m, 1);
  result.matches = residuals.size();
  if (residuals.size() < static_cast<std::size_t>(options.min_matches)) return result;
  apply_kernel(residuals, resolution_m);
  const NormalEquations equations = build_normal_equations(residuals);
  const ObservableSplit split = split_observable(equations);
  result.stop = settled ? StopReason::kConverged : StopReason::kMaxIterations;
  result.T_target_source = T;
  result.residual_rms_m = std::sqrt(equations.squares_m2 / equations.weight);
  result.centre_target_m = equations.centre_m;
  // Centroids of voxels sit within a tenth of a voxel of the surface they stand for.
  const Matrix6 about_centre = cluster_covariance(residuals, equations, split, kCell_m, 0.05 * resolution_m,
                                                  prior.translation_m, prior.rotation_rad);
  result.covariance = covariance_in_source(about_centre, equations.centre_m, T);
  for (int k = 0; k < split.unobservable; ++k) {
    result.unobservable.emplace_back((equations.unscale * split.directions.col(k)).normalized());
  }
  return result;
}

}  // namespace kilter
