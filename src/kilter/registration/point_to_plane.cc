// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/point_to_plane.h"

#include <algorithm>
#include <cmath>

#include "kilter/registration/normal_equations.h"
#include "kilter/registration/uncertainty.h"

namespace kilter {
namespace {

constexpr double kShrink = 0.7;             // search distance, from one level to the next
constexpr double kFinalSearchVoxels = 4.0;  // and where that ends
constexpr double kLevelSettled = 0.05;      // a step below this share of the search distance ends a level
constexpr int kLevelIterations = 10;        // and so do this many steps
constexpr double kKernelOfSearch = 0.5;     // kernel scale at least this share of the search distance, until the last
constexpr double kFinalKernelVoxels = 0.5;  // level, where it is at least this many voxels
constexpr double kLeastAgreement = 0.6;    // cosine between normals of matched voxels
constexpr double kSmallStep_m = 1e-3;
constexpr double kSmallTurn_rad = 1e-4;
constexpr double kSupportVoxels = 0.25;  // this near its plane a point supports the pose
constexpr std::size_t kFewestResiduals = 40;
constexpr std::size_t kAllPoints = 1U << 31;

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

// Points of `from` against the planes of `onto`, in the frame of `onto`.
void match_one_way(const NearestVoxelSearch& from, const NearestVoxelSearch& onto, const Pose3& T_onto_from,
                   double search_m, std::size_t max_points, std::vector<PlaneResidual>& residuals) {
  const SurfaceVoxels& points = from.map().voxels();
  const SurfaceVoxels& planes = onto.map().voxels();
  const bool oriented = from.map().has_free_space() && onto.map().has_free_space();
  const std::size_t stride = std::max<std::size_t>(1, points.size() / max_points);
  const Eigen::Isometry3d T = T_onto_from.isometry();
  for (std::size_t i = 0; i < points.size(); i += stride) {
    const Eigen::Vector3d point_m = T * points.centroids_m[i].cast<double>();
    const std::optional<NearestVoxel> nearest = onto.nearest(point_m, search_m);
    if (!nearest) continue;
    const Eigen::Vector3d normal = planes.normals[nearest->voxel].cast<double>();
    if (normal.isZero()) continue;
    if (!normals_agree(T.linear() * points.normals[i].cast<double>(), normal, oriented)) continue;
    const double residual_m = normal.dot(point_m - planes.centroids_m[nearest->voxel].cast<double>());
    residuals.push_back({point_m, normal, residual_m, static_cast<double>(planes.planarity[nearest->voxel])});
  }
}

// Both ways, so that it does not matter which of the two is called the source. A target point q lies off a source
// plane by (R n) . (q - T c); moving the source moves that plane, hence the turned direction.
std::vector<PlaneResidual> match_planes(const NearestVoxelSearch& source, const NearestVoxelSearch& target,
                                        const Pose3& T_target_source, double search_m, std::size_t max_points) {
  std::vector<PlaneResidual> residuals;
  match_one_way(source, target, T_target_source, search_m, max_points, residuals);
  const std::size_t forward = residuals.size();
  match_one_way(target, source, T_target_source.inverse(), search_m, max_points, residuals);
  const Eigen::Isometry3d T = T_target_source.isometry();
  for (std::size_t i = forward; i < residuals.size(); ++i) {
    residuals[i].point_m = T * residuals[i].point_m;
    residuals[i].direction = -(T.linear() * residuals[i].direction);
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

// Robust weights on top of planarity. The scale follows the residuals' own spread but never falls below `least_m`:
// where floor and ceiling are most of the scene they fit whatever the walls say, and a scale taken from them alone
// would cut the walls off before they could pull.
void apply_kernel(std::vector<PlaneResidual>& residuals, double least_m) {
  const Kernel kernel{std::max(2.0 * 1.4826 * median_absolute_m(residuals), least_m)};
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
  const auto max_points = static_cast<std::size_t>(options.max_points);
  // How many voxels one residual stands for: the gate counts voxels, of either submap.
  const double per_residual = std::max(1.0, static_cast<double>(source.map().voxels().size()) / options.max_points);
  const double resolution_m = target.map().resolution_m();
  const auto enough = [&](std::size_t count) {
    return 0.5 * static_cast<double>(count) * per_residual >= options.min_matches && count >= kFewestResiduals;
  };
  const double final_search_m = std::min(kFinalSearchVoxels * resolution_m, options.search_distance_m);
  const double final_kernel_m = kFinalKernelVoxels * resolution_m;
  double search_m = options.search_distance_m;
  Pose3 T = start;
  bool settled = false;
  int level_iterations = 0;
  while (!settled && result.iterations < options.max_iterations) {
    ++result.iterations;
    ++level_iterations;
    const bool last_level = search_m <= final_search_m;
    std::vector<PlaneResidual> residuals = match_planes(source, target, T, search_m, max_points);
    if (!enough(residuals.size())) return result;
    apply_kernel(residuals, last_level ? final_kernel_m : kKernelOfSearch * search_m);
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
    settled = last_level && step.head<3>().norm() < kSmallStep_m && step.tail<3>().norm() < kSmallTurn_rad;
    if (!last_level && (step.head<3>().norm() < kLevelSettled * search_m || level_iterations >= kLevelIterations)) {
      search_m = std::max(search_m * kShrink, final_search_m);
      level_iterations = 0;
    }
  }

  std::vector<PlaneResidual> residuals = match_planes(source, target, T, final_search_m, kAllPoints);
  result.matches = residuals.size() / 2;
  result.support_end = count_below(residuals, kSupportVoxels * resolution_m);
  result.support_start = count_below(match_planes(source, target, start, final_search_m, kAllPoints),
                                     kSupportVoxels * resolution_m);
  if (result.matches < static_cast<std::size_t>(options.min_matches)) return result;
  apply_kernel(residuals, final_kernel_m);
  const NormalEquations equations = build_normal_equations(residuals);
  const ObservableSplit split = split_observable(equations);
  result.stop = settled ? StopReason::kConverged : StopReason::kMaxIterations;
  result.T_target_source = T;
  result.residual_rms_m = std::sqrt(equations.squares_m2 / equations.weight);
  // Centroids of voxels sit within a tenth of a voxel of the surface they stand for.
  describe_uncertainty(residuals, equations, split, 0.05 * resolution_m, prior, result);
  return result;
}

}  // namespace kilter
