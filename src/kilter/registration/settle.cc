// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/settle.h"

#include <algorithm>
#include <cmath>

#include "kilter/registration/bend.h"
#include "kilter/registration/normal_equations.h"
#include "kilter/registration/plane_matches.h"
#include "kilter/registration/slide_contrast.h"
#include "kilter/registration/uncertainty.h"

namespace kilter {
namespace {

constexpr int kPolishSteps = 3;
constexpr double kPolished_m = 1e-4;
constexpr double kPolished_rad = 1e-5;
constexpr double kSlidVoxels = 0.25;  // a motion this small along a free direction is not worth another descent

// All correspondences at a pose, robustly weighted, and what they fix.
struct Look {
  std::vector<PlaneResidual> residuals;
  NormalEquations equations;
  ObservableSplit split;
  std::size_t supporting = 0;  // residuals below kPlaneSupportVoxels
};

void look_at(PlanePair& pair, const Pose3& T_target_source, const RegistrationOptions& options, const HeldMotions& held,
             Look& look) {
  match_planes(pair, T_target_source, final_search_m(pair.grain, options), kAllPoints, look.residuals);
  look.supporting = count_below(look.residuals, support_m(pair.grain));
  look.equations = {};
  look.split = {};
  if (look.residuals.empty()) return;
  apply_kernel(look.residuals, kFinalKernelVoxels * pair.grain.edge_m);
  look.equations = build_normal_equations(look.residuals);
  look.split = split_beside(look.equations, held);
}

// The part of the motion from the start to T that lies along directions which nothing fixes there, as (v, w) about the
// centre.
Vector6 free_motion(const Pose3& start, const Pose3& T, const Look& look) {
  const Pose3 moved = T * start.inverse();
  Vector6 motion;
  motion.head<3>() = look.equations.centre_m - moved.inverse() * look.equations.centre_m;
  motion.tail<3>() = moved.log().tail<3>();
  return motion - fixed_part(look.equations, look.split, motion);
}

// How many residuals are small and face the motion that takes their points by `moved_m(point)`.
template <typename Motion>
std::size_t count_facing(std::span<const PlaneResidual> residuals, double limit_m, const Motion& moved_m) {
  return static_cast<std::size_t>(std::count_if(residuals.begin(), residuals.end(), [&](const PlaneResidual& r) {
    return std::abs(r.residual_m) < limit_m && faces(r.direction, moved_m(r.point_m));
  }));
}

// The descent looks at a part of the voxels; all of them tell better. `look` is at the pose that they end at.
void polish(PlanePair& pair, const RegistrationOptions& options, const HeldMotions& held, Pose3& T_target_source,
            Look& look) {
  look_at(pair, T_target_source, options, held, look);
  for (int k = 0; k < kPolishSteps && look.split.unobservable < 6; ++k) {
    const Vector6 step = solve_observable(look.equations, look.split);
    T_target_source = motion_about(look.equations.centre_m, step) * T_target_source;
    look_at(pair, T_target_source, options, held, look);
    if (step.head<3>().norm() < kPolished_m && step.tail<3>().norm() < kPolished_rad) break;
  }
}

// Slides along what seems hardly fixed. Directions that turn out not to be are added to `held`; for the others, it says
// how far clutter blurs them. \return how many were added.
std::size_t doubt_weak_directions(PlanePair& pair, const Pose3& T_target_source, Look& look, HeldMotions& held) {
  const std::size_t before = held.size();
  for (int k = look.split.unobservable; k < 6 && look.split.shares[k] < kEnoughShare; ++k) {
    const Vector6 motion = motion_of_frame(look.equations, look.split.directions.col(k));
    const SlideContrast contrast = slide_contrast(pair, T_target_source, motion);
    if (contrast.fixed()) {
      look.split.blur_m[k] = contrast.blur_voxels() * pair.grain.edge_m;
    } else {
      held.push_back(motion);
    }
  }
  return held.size() - before;
}

// The pose where a descent ended, settled on all voxels, with what is not fixed there held at the start. A pose found
// along a direction that nothing fixes is where the search happened to stop: coarse levels and the wide search slide
// along corridors to wherever most overlaps. Such a direction is taken back to the start, and the others settle again.
Look settle(PlanePair& pair, const Pose3& start, const RegistrationOptions& options, Descent& descent) {
  const double edge_m = pair.grain.edge_m;
  RegistrationOptions close = options;
  close.search_distance_m = std::min(options.search_distance_m, kCloseSearchVoxels * edge_m);
  HeldMotions held;
  Look look;
  while (true) {
    polish(pair, options, held, descent.T, look);
    if (look.residuals.empty() || doubt_weak_directions(pair, descent.T, look, held) == 0) return look;
    look.split = split_beside(look.equations, held);
    const Vector6 slid = free_motion(start, descent.T, look);
    descent.T = motion_about(look.equations.centre_m, -slid) * descent.T;
    if ((look.equations.unscale.inverse() * slid).norm() < kSlidVoxels * edge_m) continue;
    const int before = descent.iterations;
    descent = descend(pair, descent.T, close, kWideRefinement_m, held);
    descent.iterations += before;
    if (!descent.ended()) return look;
  }
}

// The motion that leaves the least apart where a submap is bent, along what the scene fixes, about the look's centre.
Vector6 to_least_apart(const Bend& bend, const Look& look) {
  Vector6 motion = bend.common;
  motion.head<3>() += bend.common.tail<3>().cross(look.equations.centre_m - bend.centre_m);
  return fixed_part(look.equations, look.split, motion);
}

// All voxels of a cell are one measurement.
std::size_t in_cells(std::size_t voxels, const PairGrain& grain) {
  return static_cast<std::size_t>(std::lround(static_cast<double>(voxels) / grain.voxels_per_cell));
}

// Voxels that fit where the start has them, and where the end has them, of those that face the way between: floors fit
// at every shift along them, walls at every height.
void count_support(PlanePair& pair, const Pose3& start, const Pose3& end, double search_m,
                   std::span<const PlaneResidual> at_end, RegistrationResult& result) {
  const double near_m = support_m(pair.grain);
  const Eigen::Isometry3d moved = (end * start.inverse()).isometry();
  const Eigen::Isometry3d back = moved.inverse();
  const std::vector<PlaneResidual> at_start = match_planes(pair, start, search_m, kAllPoints);
  const auto from_start = [&](const Eigen::Vector3d& point_m) -> Eigen::Vector3d { return moved * point_m - point_m; };
  const auto to_end = [&](const Eigen::Vector3d& point_m) -> Eigen::Vector3d { return point_m - back * point_m; };
  result.support_start = in_cells(count_facing(at_start, near_m, from_start), pair.grain);
  result.support_end = in_cells(count_facing(at_end, near_m, to_end), pair.grain);
}

}  // namespace

RegistrationResult settled_result(PlanePair& pair, const Pose3& start, Descent descent,
                                  const RegistrationOptions& options, const RegistrationPrior& prior) {
  RegistrationResult result;
  result.T_target_source = result.T_target_source_closest = start;
  Look look;
  if (descent.ended()) look = settle(pair, start, options, descent);
  result.iterations = descent.iterations;
  result.stop = descent.stop;
  if (!descent.ended()) return result;
  result.matches = look.residuals.size() / 2;
  if (look.residuals.empty() ||
      in_cells(look.supporting, pair.grain) < 2 * static_cast<std::size_t>(options.min_matches)) {
    result.stop = StopReason::kTooFewMatches;
    return result;
  }
  // A descent knows only where it began itself, which may be a coarse pose or what a neighbour asked for.
  if ((descent.T * start.inverse()).angle_rad() > options.max_rotation_rad) {
    result.stop = StopReason::kOutOfRange;
    return result;
  }
  count_support(pair, start, descent.T, final_search_m(pair.grain, options), look.residuals, result);
  const std::vector<PlaneResidual> planes = match_planes(pair, descent.T, options.search_distance_m, kBendPoints);
  result.bend = measure_bend(pair, descent.T, options.search_distance_m, planes);
  result.T_target_source_closest = descent.T;
  const Vector6 motion = to_least_apart(result.bend, look);
  result.T_target_source = motion_about(look.equations.centre_m, (1.0 - result.bend.noise_share) * motion) * descent.T;
  result.residual_rms_m = std::sqrt(look.equations.squares_m2 / look.equations.weight);
  result.covariance_cells = cell_covariance(look.residuals, look.equations, look.split, pair.grain.variance_m2);
  result.covariance_measured = plane_covariance(look.residuals, look.equations, look.split, result.bend) +
                               result.covariance_cells + result.bend.noise_share * motion * motion.transpose();
  result.place_m = place_edge_m(pair.grain);
  describe_uncertainty(result.bend.places, look.equations, look.split, prior, result);
  return result;
}

}  // namespace kilter
