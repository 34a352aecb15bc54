// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/point_to_plane.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "kilter/matching/conflict.h"
#include "kilter/registration/coarse_search.h"
#include "kilter/registration/normal_equations.h"
#include "kilter/registration/plane_matches.h"
#include "kilter/registration/slide_contrast.h"
#include "kilter/registration/uncertainty.h"

namespace kilter {
namespace {

constexpr double kShrink = 0.7;             // search distance, from one level to the next
constexpr double kFinalSearchVoxels = 4.0;  // and where that ends
constexpr double kLevelSettled = 0.05;      // a step below this share of the search distance ends a level
constexpr int kLevelIterations = 10;        // and so do this many steps
constexpr double kKernelOfSearch = 0.5;     // kernel scale at least this share of the search distance, until the last
constexpr double kFinalKernelVoxels = 0.5;  // level, where it is at least this many voxels
constexpr double kSmallStep_m = 1e-3;
constexpr double kSmallTurn_rad = 1e-4;
constexpr std::size_t kFewestResiduals = 40;
constexpr int kPolishSteps = 3;
constexpr double kPolished_m = 1e-4;
constexpr double kPolished_rad = 1e-5;
constexpr double kSlidVoxels = 0.25;  // a motion this small along a free direction is not worth another descent
// The wide search.
constexpr int kWideStarts = 10;
constexpr int kWidePoints = 600;             // while descending from each of them
constexpr std::size_t kJudgedVoxels = 6000;  // of the larger submap, to tell the best
constexpr int kWideIterations = 18;
constexpr double kLeastCoarseShare = 0.6;  // of the best coarse score, to be descended from
constexpr double kConflictCost = 3.0;      // voxels of support that one conflicting voxel outweighs
constexpr double kHomeBonus = 1.2;         // the map's own basin is left for something clearly better only
// And never for what merely overlaps more: of what both saw, home supports nearly as large a share, and at most half as
// much of it conflicts. Not where home is a fringe that both saw by chance.
constexpr double kSameSupport = 0.8;
constexpr double kFringe = 0.3;  // of the support elsewhere
constexpr double kConflictAtHome = 0.5;
constexpr double kLeastConflictMore = 0.005;
constexpr double kWideRefinement_m = 1.0;  // a coarse pose is good to a cell or two
constexpr double kWideTurn_rad = 0.05;
constexpr double kMostRise_m = 1.0;         // vertically; lidar poses drift less in height
constexpr double kDistinctVoxels = 5.0;     // optima nearer than this are one
constexpr double kSameVoxels = 1.0;         // and nearer than this, judged once
constexpr double kCloseSearchVoxels = 6.0;  // for the last descent, from the best

bool out_of_range(const Pose3& start, const Pose3& now, const Eigen::Vector3d& centre_target_m, double range_m,
                  double max_rotation_rad) {
  const Pose3 moved = now * start.inverse();
  const double shift_m = (moved * centre_target_m - centre_target_m).norm();
  return shift_m > range_m || moved.angle_rad() > max_rotation_rad;
}

// What the iterations of one search leave behind.
struct Descent {
  StopReason stop = StopReason::kTooFewMatches;
  Pose3 T;
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();  // of what last met, target frame
  int iterations = 0;

  [[nodiscard]] bool ended() const { return stop == StopReason::kConverged || stop == StopReason::kMaxIterations; }
};

double final_search_m(const PairGrain& grain, const RegistrationOptions& options) {
  return std::min(kFinalSearchVoxels * grain.edge_m, options.search_distance_m);
}

// Motions v0 + w x p of the target frame along which a search does not move.
using HeldMotions = std::vector<Vector6>;

// From the start into the nearest optimum, at most range_m away.
Descent descend(PlanePair& pair, const Pose3& start, const RegistrationOptions& options, double range_m,
                const HeldMotions& held = {}) {
  const auto max_points = static_cast<std::size_t>(options.max_points);
  // How many voxels one residual stands for: the gate counts voxels, of either submap.
  const double per_residual =
      std::max(1.0, static_cast<double>(pair.source_map().voxels().size()) / options.max_points);
  const auto enough = [&](std::size_t count) {
    return 0.5 * static_cast<double>(count) * per_residual >= options.min_matches * pair.grain.voxels_per_cell &&
           count >= kFewestResiduals;
  };
  const double last_search_m = final_search_m(pair.grain, options);
  const double final_kernel_m = kFinalKernelVoxels * pair.grain.edge_m;
  Descent descent;
  descent.T = start;
  double search_m = options.search_distance_m;
  bool settled = false;
  int level_iterations = 0;
  while (!settled && descent.iterations < options.max_iterations) {
    ++descent.iterations;
    ++level_iterations;
    const bool last_level = search_m <= last_search_m;
    std::vector<PlaneResidual> residuals = match_planes(pair, descent.T, search_m, max_points);
    if (!enough(residuals.size())) return descent;
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

// All correspondences at a pose, robustly weighted, and what they fix.
struct Look {
  std::vector<PlaneResidual> residuals;
  NormalEquations equations;
  ObservableSplit split;
  std::size_t supporting = 0;  // residuals below kPlaneSupportVoxels
};

Look look_at(PlanePair& pair, const Pose3& T_target_source, const RegistrationOptions& options,
             const HeldMotions& held) {
  Look look;
  look.residuals = match_planes(pair, T_target_source, final_search_m(pair.grain, options), kAllPoints);
  look.supporting = count_below(look.residuals, support_m(pair.grain));
  if (look.residuals.empty()) return look;
  apply_kernel(look.residuals, kFinalKernelVoxels * pair.grain.edge_m);
  look.equations = build_normal_equations(look.residuals);
  look.split = split_beside(look.equations, held);
  return look;
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

// The descent looks at a part of the voxels; all of them tell better. \return the look at the pose that they end at.
Look polish(PlanePair& pair, const RegistrationOptions& options, const HeldMotions& held, Pose3& T_target_source) {
  Look look = look_at(pair, T_target_source, options, held);
  for (int k = 0; k < kPolishSteps && look.split.unobservable < 6; ++k) {
    const Vector6 step = solve_observable(look.equations, look.split);
    T_target_source = motion_about(look.equations.centre_m, step) * T_target_source;
    look = look_at(pair, T_target_source, options, held);
    if (step.head<3>().norm() < kPolished_m && step.tail<3>().norm() < kPolished_rad) break;
  }
  return look;
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
  while (true) {
    Look look = polish(pair, options, held, descent.T);
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

// Judges where a descent ended on all voxels.
RegistrationResult finish(PlanePair& pair, const Pose3& start, Descent descent, const RegistrationOptions& options,
                          const RegistrationPrior& prior) {
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
  count_support(pair, start, descent.T, final_search_m(pair.grain, options), look.residuals, result);
  const std::vector<PlaneResidual> places = match_planes(pair, descent.T, options.search_distance_m, kBendPoints);
  result.bend = measure_bend(pair, descent.T, options.search_distance_m, places);
  result.T_target_source_closest = descent.T;
  const Vector6 motion = to_least_apart(result.bend, look);
  result.T_target_source = motion_about(look.equations.centre_m, (1.0 - result.bend.noise_share) * motion) * descent.T;
  result.residual_rms_m = std::sqrt(look.equations.squares_m2 / look.equations.weight);
  result.covariance_cells = cell_covariance(look.residuals, look.equations, look.split, pair.grain.variance_m2);
  result.covariance_measured = plane_covariance(look.residuals, look.equations, look.split, result.bend) +
                               result.covariance_cells + result.bend.noise_share * motion * motion.transpose();
  describe_uncertainty(places, look.equations, look.split, prior, result);
  return result;
}

// A pose that a descent from one of the starts ended at.
struct Optimum {
  Descent descent;
  /// Voxels that a plane supports, less kConflictCost for each that stands where the other submap saw through: a pose
  /// that merely overlaps more gathers support, and conflict with it.
  double worth = 0.0;
  double support = 0.0;        ///< voxels
  double support_share = 0.0;  ///< of what both saw
  double conflict_share = 0.0;
};

// Of two that look alike, aisles or storeys, the one that overlaps more gathers more support, though it conflicts.
bool merely_overlaps_more(const Optimum& other, const Optimum& home) {
  return home.support >= kFringe * other.support && home.support_share >= kSameSupport * other.support_share &&
         home.conflict_share <= kConflictAtHome * other.conflict_share &&
         other.conflict_share - home.conflict_share >= kLeastConflictMore;
}

Optimum judged(PlanePair& pair, const Descent& descent, const RegistrationOptions& options) {
  const std::size_t larger = std::max(pair.source_map().voxels().size(), pair.target_map().voxels().size());
  const std::size_t stride = std::max<std::size_t>(1, larger / kJudgedVoxels);
  const std::size_t support =
      count_below(match_every(pair, descent.T, final_search_m(pair.grain, options), stride), support_m(pair.grain));
  const ConflictSample conflict =
      sample_conflict(pair.in_source.cursor(), pair.in_target.cursor(), descent.T,
                      conflict_margin_m(pair.in_source.search(), pair.in_target.search()), stride);
  const std::size_t conflicting = conflict.source_in_target.conflicting + conflict.target_in_source.conflicting;
  const double worth = static_cast<double>(support) - kConflictCost * static_cast<double>(conflicting);
  const auto known = static_cast<double>(std::max<std::size_t>(conflict.known(), 1));
  return {descent, worth * static_cast<double>(stride), static_cast<double>(support * stride),
          static_cast<double>(support) / known, conflict.share()};
}

// RMS over points at the source's own spread would need them all; its box is near enough to tell optima apart.
double apart_m(const VoxelMap& source, const Pose3& a, const Pose3& b) {
  const Eigen::AlignedBox3d& box = source.bounds_m();
  double largest_m = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d half_m = 0.25 * box.sizes();  // half way out: few points lie in the corners
    const Eigen::Vector3d at_m = box.center() + Eigen::Vector3d((corner & 1) != 0 ? half_m.x() : -half_m.x(),
                                                                (corner & 2) != 0 ? half_m.y() : -half_m.y(),
                                                                (corner & 4) != 0 ? half_m.z() : -half_m.z());
    largest_m = std::max(largest_m, (a * at_m - b * at_m).norm());
  }
  return largest_m;
}

}  // namespace

RegistrationResult align_point_to_plane(const NearestVoxelSearch& source, const NearestVoxelSearch& target,
                                        const Pose3& start, const RegistrationOptions& options,
                                        const RegistrationPrior& prior) {
  PlanePair pair{source, target};
  const Descent descent = descend(pair, start, options, prior.translation_m + options.search_distance_m);
  return finish(pair, start, descent, options, prior);
}

RegistrationResult align_widely(const NearestVoxelSearch& source, const NearestVoxelSearch& target, const Pose3& start,
                                const RegistrationOptions& options, const RegistrationPrior& prior) {
  PlanePair pair{source, target};
  const double edge_m = pair.grain.edge_m;
  const double reach_m = std::max(options.wide_translation_m, prior.translation_m);
  const CoarseSearchRange range{reach_m, std::min(reach_m, kMostRise_m), options.max_rotation_rad};
  std::vector<Pose3> starts = {start};
  const std::vector<CoarsePose> coarse =
      coarse_search(source.map(), target.map(), start, range, prior.up_target, kWideStarts);
  for (const CoarsePose& pose : coarse) {
    if (pose.score >= kLeastCoarseShare * coarse.front().score) starts.push_back(pose.T_target_source);
  }
  RegistrationOptions quick = options;
  quick.max_points = std::min(options.max_points, kWidePoints);
  quick.max_iterations = std::min(options.max_iterations, kWideIterations);
  std::vector<Optimum> optima;
  std::optional<Optimum> home;
  for (const Pose3& from : starts) {
    // A coarse pose is a cell or two off; from the map's own pose the whole way is open.
    const double range_m = from.translation_m() == start.translation_m() ? reach_m : kWideRefinement_m;
    const Descent descent = descend(pair, from, quick, range_m + options.search_distance_m);
    if (!descent.ended()) continue;
    // The coarse search turns about the source's middle, which may lie far from what meets in the end.
    if (out_of_range(start, descent.T, descent.centre_m, reach_m + kWideRefinement_m,
                     options.max_rotation_rad + kWideTurn_rad)) {
      continue;
    }
    const bool known = std::any_of(optima.begin(), optima.end(), [&](const Optimum& other) {
      return apart_m(source.map(), other.descent.T, descent.T) < kSameVoxels * edge_m;
    });
    if (known) continue;
    Optimum found = judged(pair, descent, options);
    if (home && merely_overlaps_more(found, *home)) continue;
    if (&from == &starts.front() && found.worth > 0.0) {
      found.worth *= kHomeBonus;
      home = found;
    }
    optima.push_back(found);
  }
  if (optima.empty()) {
    RegistrationResult result;
    result.T_target_source = result.T_target_source_closest = start;
    result.searched = true;
    return result;
  }
  const auto best = std::max_element(optima.begin(), optima.end(),
                                     [](const Optimum& a, const Optimum& b) { return a.worth < b.worth; });
  const Optimum* runner_up = nullptr;
  for (const Optimum& other : optima) {
    if (apart_m(source.map(), other.descent.T, best->descent.T) < kDistinctVoxels * edge_m) continue;
    if (runner_up == nullptr || other.worth > runner_up->worth) runner_up = &other;
  }
  RegistrationOptions close = options;
  close.search_distance_m = std::min(options.search_distance_m, kCloseSearchVoxels * edge_m);
  Descent descent = descend(pair, best->descent.T, close, kWideRefinement_m);
  if (descent.stop != StopReason::kConverged) descent = best->descent;
  RegistrationResult result = finish(pair, start, descent, options, prior);
  result.searched = true;
  result.worth = best->worth;
  result.ambiguity = runner_up == nullptr ? 0.0 : std::clamp(runner_up->worth / std::max(best->worth, 1.0), 0.0, 1.0);
  if (runner_up != nullptr) result.T_target_source_runner_up = runner_up->descent.T;
  return result;
}

RegistrationResult align_near(const NearestVoxelSearch& source, const NearestVoxelSearch& target, const Pose3& start,
                              const Pose3& guess, const RegistrationOptions& options, const RegistrationPrior& prior) {
  PlanePair pair{source, target};
  const Descent descent = descend(pair, guess, options, kWideRefinement_m);
  RegistrationResult result = finish(pair, start, descent, options, prior);
  result.searched = true;
  if (result.converged()) result.worth = judged(pair, descent, options).worth;
  return result;
}

}  // namespace kilter
