// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/oicp.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "kilter/matching/nearest_of_all.h"
#include "kilter/matching/pair_grain.h"
#include "kilter/registration/normal_equations.h"
#include "kilter/registration/uncertainty.h"

namespace kilter {
namespace {

constexpr double kShrink = 0.85;
constexpr double kFinalSearchVoxels = 3.0;
constexpr double kCreepVoxels = 0.05;  // the search narrows once a step is shorter than this
constexpr double kMaxOccupancyDifference = 0.4;
constexpr double kSmallTurn_rad = 1e-4;
constexpr int kSettledIterations = 3;
constexpr double kSupportVoxels = 0.5;
// Points that meet points lie off along the surface too, all of a patch alike: on 0.1 m voxels it ends 9-11 cm off.
constexpr double kPatchVoxels = 3.5;

struct PointMatch {
  Eigen::Vector3d source_m;  // in the target's frame
  Eigen::Vector3d target_m;
  std::uint32_t target_voxel = 0;
  double distance_m = 0.0;
  double weight = 0.0;
};

// \param nearest  of the last step, and of this one.
std::vector<PointMatch> match_points(const NearestVoxelSearch& source, const NearestVoxelSearch& target,
                                     const Pose3& T_target_source, double search_m,
                                     std::vector<NearestVoxel>& nearest) {
  const Eigen::Isometry3d T = T_target_source.isometry();
  const double two_voxels_m = 2.0 * target.map().resolution_m();
  nearest_of_all_again(source, target, T_target_source, search_m, nearest);
  std::vector<PointMatch> matches;
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    const auto [voxel, distance_m] = nearest[i];
    if (voxel == kNoVoxel) continue;
    const double p_source = source.map().probability(i);
    const double p_target = target.map().probability(voxel);
    if (std::abs(p_source - p_target) > kMaxOccupancyDifference) continue;
    const double ratio = distance_m / two_voxels_m;
    matches.push_back({T * voxel_position_m(source.map(), i, source.position()),
                       voxel_position_m(target.map(), voxel, target.position()), voxel, distance_m,
                       p_source * p_target / (1.0 + ratio * ratio)});
  }
  return matches;
}

// Keeps the nearest source of every target voxel, then the best of those, `most` at most.
void trim(std::vector<PointMatch>& matches, std::size_t most) {
  std::stable_sort(matches.begin(), matches.end(), [](const PointMatch& a, const PointMatch& b) {
    return a.target_voxel != b.target_voxel ? a.target_voxel < b.target_voxel : a.distance_m < b.distance_m;
  });
  matches.erase(std::unique(matches.begin(), matches.end(),
                            [](const PointMatch& a, const PointMatch& b) { return a.target_voxel == b.target_voxel; }),
                matches.end());
  std::stable_sort(matches.begin(), matches.end(),
                   [](const PointMatch& a, const PointMatch& b) { return a.distance_m < b.distance_m; });
  matches.resize(std::min(matches.size(), most));
}

// The rigid motion that brings weighted source points closest to their targets (Kabsch).
Pose3 rigid_fit(const std::vector<PointMatch>& matches) {
  double weight = 0.0;
  Eigen::Vector3d source_mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d target_mean = Eigen::Vector3d::Zero();
  for (const PointMatch& m : matches) {
    weight += m.weight;
    source_mean += m.weight * m.source_m;
    target_mean += m.weight * m.target_m;
  }
  source_mean /= weight;
  target_mean /= weight;
  Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();
  for (const PointMatch& m : matches) {
    cross += m.weight * (m.source_m - source_mean) * (m.target_m - target_mean).transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d flip = Eigen::Matrix3d::Identity();
  flip(2, 2) = (svd.matrixV() * svd.matrixU().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  const Eigen::Matrix3d R = svd.matrixV() * flip * svd.matrixU().transpose();
  return {Eigen::Quaterniond(R), target_mean - R * source_mean};
}

// Every axis of a point-to-point match is one residual: that makes the same normal equations serve.
std::vector<PlaneResidual> axis_residuals(const std::vector<PointMatch>& matches) {
  std::vector<PlaneResidual> residuals;
  residuals.reserve(3 * matches.size());
  for (const PointMatch& m : matches) {
    for (int axis = 0; axis < 3; ++axis) {
      residuals.push_back({m.source_m, Eigen::Vector3d::Unit(axis), (m.source_m - m.target_m)[axis], m.weight});
    }
  }
  return residuals;
}

// Which directions the target's surfaces fix. Points that meet points seem to fix all six, wherever along a corridor
// the search stopped.
ObservableSplit split_by_surfaces(const std::vector<PointMatch>& matches, const SurfaceVoxels& target,
                                  const NormalEquations& of_points) {
  std::vector<PlaneResidual> residuals;
  residuals.reserve(matches.size());
  for (const PointMatch& m : matches) {
    const Eigen::Vector3d normal = target.normals[m.target_voxel].cast<double>();
    if (normal.isZero()) continue;
    residuals.push_back({m.source_m, normal, (m.source_m - m.target_m).dot(normal),
                         m.weight * static_cast<double>(target.planarity[m.target_voxel])});
  }
  const NormalEquations of_planes = build_normal_equations(residuals);
  const ObservableSplit split = split_observable(of_planes, residuals);
  std::vector<Vector6> open;
  for (int k = 0; k < split.unobservable; ++k) open.push_back(motion_of_frame(of_planes, split.directions.col(k)));
  return split_beside(of_points, open);
}

std::size_t matched_at(const NearestVoxelSearch& source, const NearestVoxelSearch& target, const Pose3& T,
                       double search_m) {
  const std::vector<NearestVoxel> nearest = nearest_of_all(source, target, T, search_m);
  return static_cast<std::size_t>(
      std::count_if(nearest.begin(), nearest.end(), [](const NearestVoxel& each) { return each.voxel != kNoVoxel; }));
}

double overlap_at(const NearestVoxelSearch& source, const NearestVoxelSearch& target, const Pose3& T, double search_m) {
  const std::size_t count = source.map().voxels().size();
  return count == 0 ? 0.0 : static_cast<double>(matched_at(source, target, T, search_m)) / static_cast<double>(count);
}

}  // namespace

RegistrationResult align_oicp(const NearestVoxelSearch& source, const NearestVoxelSearch& target, const Pose3& start,
                              const RegistrationOptions& options, const RegistrationPrior& prior) {
  RegistrationResult result;
  result.T_target_source = result.T_target_source_closest = start;
  const double resolution_m = target.map().resolution_m();
  const double final_search_m = std::min(kFinalSearchVoxels * resolution_m, options.search_distance_m);
  const double start_overlap = overlap_at(source, target, start, options.search_distance_m);
  // The overlap is a share of the source, and so is what is kept of it: the search distance has already dropped the
  // rest, and a share of what is left would drop what disagrees.
  const auto most = static_cast<std::size_t>(
      std::ceil(std::clamp(start_overlap, 0.3, 0.9) * static_cast<double>(source.map().voxels().size())));
  double search_m = options.search_distance_m;
  Pose3 T = start;
  std::vector<PointMatch> matches;
  std::vector<NearestVoxel> nearest(source.map().voxels().size(), NearestVoxel{kNoVoxel, 0.0});
  int settled = 0;
  while (settled < kSettledIterations && result.iterations < options.max_iterations) {
    ++result.iterations;
    matches = match_points(source, target, T, search_m, nearest);
    trim(matches, most);
    if (matches.size() < static_cast<std::size_t>(options.min_matches)) return result;
    const Pose3 step = rigid_fit(matches);
    T = step * T;
    const Pose3 moved = T * start.inverse();
    if (moved.angle_rad() > options.max_rotation_rad ||
        (moved * matches.front().source_m - matches.front().source_m).norm() >
            prior.translation_m + options.search_distance_m) {
      result.stop = StopReason::kOutOfRange;
      return result;
    }
    const Eigen::Vector3d probe_m = matches.front().source_m;
    const double step_m = (step * probe_m - probe_m).norm();
    const bool small = step_m < resolution_m / 200.0 && step.angle_rad() < kSmallTurn_rad;
    settled = small && search_m <= final_search_m ? settled + 1 : 0;
    if (step_m < kCreepVoxels * resolution_m) search_m = std::max(search_m * kShrink, final_search_m);
  }
  if (overlap_at(source, target, T, options.search_distance_m) < kOverlapKept * start_overlap) {
    result.stop = StopReason::kOverlapLost;
    return result;
  }
  const std::vector<PlaneResidual> residuals = axis_residuals(matches);
  const NormalEquations equations = build_normal_equations(residuals);
  const ObservableSplit split = split_by_surfaces(matches, target.map().voxels(), equations);
  result.stop = settled >= kSettledIterations ? StopReason::kConverged : StopReason::kMaxIterations;
  result.T_target_source = result.T_target_source_closest = T;
  result.matches = matches.size();
  result.support_start = matched_at(source, target, start, kSupportVoxels * resolution_m);
  result.support_end = matched_at(source, target, T, kSupportVoxels * resolution_m);
  result.residual_rms_m = std::sqrt(3.0 * equations.squares_m2 / equations.weight);
  // Points of two lattices settle within half a voxel of each other.
  result.covariance_measured = patch_covariance(residuals, equations, split, kPatch_m, kPatchVoxels * resolution_m);
  const PairGrain grain = grain_of(source.map(), target.map());
  result.covariance_cells = cell_covariance(residuals, equations, split, grain.variance_m2);
  result.covariance_measured += result.covariance_cells;
  describe_uncertainty(moments_of(places_of(residuals, place_edge_m(grain))), equations, split, prior, result);
  return result;
}

}  // namespace kilter
