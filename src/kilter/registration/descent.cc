// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/descent.h"

#include <algorithm>

#include "kilter/registration/normal_equations.h"

namespace kilter {
namespace {

constexpr double kShrink = 0.7;             // search distance, from one level to the next
constexpr double kFinalSearchVoxels = 4.0;  // and where that ends
constexpr double kLevelSettled = 0.05;      // a step below this share of the search distance ends a level
constexpr int kLevelIterations = 10;        // and so do this many steps
constexpr double kKernelOfSearch = 0.5;     // kernel scale at least this share of the search distance, but at the end
constexpr double kSmallStep_m = 1e-3;
constexpr double kSmallTurn_rad = 1e-4;
constexpr std::size_t kFewestResiduals = 40;

}  // namespace

double final_search_m(const PairGrain& grain, const RegistrationOptions& options) {
  return std::min(kFinalSearchVoxels * grain.edge_m, options.search_distance_m);
}

bool out_of_range(const Pose3& start, const Pose3& now, const Eigen::Vector3d& centre_target_m, double range_m,
                  double max_rotation_rad) {
  const Pose3 moved = now * start.inverse();
  const double shift_m = (moved * centre_target_m - centre_target_m).norm();
  return shift_m > range_m || moved.angle_rad() > max_rotation_rad;
}

Descent descend(PlanePair& pair, const Pose3& start, const RegistrationOptions& options, double range_m,
                const HeldMotions& held) {
  const auto max_points = static_cast<std::size_t>(options.max_points);
  // The gate counts voxels, of either submap.
  const double least_voxels = 2.0 * options.min_matches * pair.grain.voxels_per_cell;
  const double last_search_m = final_search_m(pair.grain, options);
  const double final_kernel_m = kFinalKernelVoxels * pair.grain.edge_m;
  Descent descent;
  descent.T = start;
  double search_m = options.search_distance_m;
  bool settled = false;
  int level_iterations = 0;
  std::vector<PlaneResidual> residuals;
  while (!settled && descent.iterations < options.max_iterations) {
    ++descent.iterations;
    ++level_iterations;
    const bool last_level = search_m <= last_search_m;
    const std::size_t voxels = match_planes(pair, descent.T, search_m, max_points, residuals);
    if (static_cast<double>(voxels) < least_voxels || residuals.size() < kFewestResiduals) return descent;
    apply_kernel(residuals, last_level ? final_kernel_m : kKernelOfSearch * search_m);
    const NormalEquations equations = build_normal_equations(residuals);
    const ObservableSplit split = held.empty() ? split_observable(equations, residuals) : split_beside(equations, held);
    if (split.unobservable == 6) {
      descent.stop = StopReason::kDegenerate;
      return descent;
    }
    const Vector6 step = solve_observable(equations, split);
    descent.T = motion_about(equations.centre_m, step) * descent.T;
    descent.centre_m = equations.centre_m;
    if (out_of_range(start, descent.T, equations.centre_m, range_m, options.max_rotation_rad)) {
      descent.stop = StopReason::kOutOfRange;
      return descent;
    }
    settled = last_level && step.head<3>().norm() < kSmallStep_m && step.tail<3>().norm() < kSmallTurn_rad;
    if (!last_level && (step.head<3>().norm() < kLevelSettled * search_m || level_iterations >= kLevelIterations)) {
      search_m = std::max(search_m * kShrink, last_search_m);
      level_iterations = 0;
    }
  }
  descent.stop = settled ? StopReason::kConverged : StopReason::kMaxIterations;
  return descent;
}

}  // namespace kilter
