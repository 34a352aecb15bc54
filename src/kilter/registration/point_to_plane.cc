// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/point_to_plane.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "kilter/matching/conflict.h"
#include "kilter/registration/coarse_search.h"
#include "kilter/registration/descent.h"
#include "kilter/registration/plane_matches.h"
#include "kilter/registration/settle.h"
#include "kilter/registration/uncertainty.h"

namespace kilter {
namespace {

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
constexpr double kWideTurn_rad = 0.05;
constexpr double kMostRise_m = 1.0;      // vertically; lidar poses drift less in height
constexpr double kDistinctVoxels = 5.0;  // optima nearer than this are one
constexpr double kSameVoxels = 1.0;      // and nearer than this, judged once

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

// Whether a pose is the settled one but for a slide along a corridor, the one direction that the scene leaves open:
// that is named already and is no other place. Over the places that both saw the rest of the motion is less than
// `least_m` (RMS). Where more is open the two share little but a floor, and what fits beside may well be another place.
bool is_slide(const RegistrationResult& result, const Pose3& T_target_source, double least_m) {
  if (result.unobservable.size() != 1) return false;
  const Eigen::Vector3d middle_m = result.centre_target_m + result.places_arm_m;
  const Pose3 back = result.T_target_source_closest * T_target_source.inverse();
  Vector6 motion;
  motion << back * middle_m - middle_m, back.log().tail<3>();
  const Matrix6 M = displacement_form(Eigen::Vector3d::Zero(),
                                      result.scatter_m2 - result.places_arm_m * result.places_arm_m.transpose());
  const Vector6& open = result.unobservable.front();
  const Vector6 rest = motion - open.dot(M * motion) / open.dot(M * open) * open;
  return rest.dot(M * rest) < least_m * least_m;
}

}  // namespace

RegistrationResult align_point_to_plane(const NearestVoxelSearch& source, const NearestVoxelSearch& target,
                                        const Pose3& start, const RegistrationOptions& options,
                                        const RegistrationPrior& prior) {
  PlanePair pair{source, target};
  const Descent descent = descend(pair, start, options, prior.translation_m + options.search_distance_m);
  return settled_result(pair, start, descent, options, prior);
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
  RegistrationOptions close = options;
  close.search_distance_m = std::min(options.search_distance_m, kCloseSearchVoxels * edge_m);
  Descent descent = descend(pair, best->descent.T, close, kWideRefinement_m);
  if (descent.stop != StopReason::kConverged) descent = best->descent;
  RegistrationResult result = settled_result(pair, start, descent, options, prior);
  result.searched = true;
  result.worth = best->worth;
  const Optimum* runner_up = nullptr;
  for (const Optimum& other : optima) {
    if (apart_m(source.map(), other.descent.T, best->descent.T) < kDistinctVoxels * edge_m) continue;
    if (is_slide(result, other.descent.T, kDistinctVoxels * edge_m)) continue;
    if (runner_up == nullptr || other.worth > runner_up->worth) runner_up = &other;
  }
  result.ambiguity = runner_up == nullptr ? 0.0 : std::clamp(runner_up->worth / std::max(best->worth, 1.0), 0.0, 1.0);
  if (runner_up != nullptr) result.T_target_source_runner_up = runner_up->descent.T;
  return result;
}

RegistrationResult align_near(const NearestVoxelSearch& source, const NearestVoxelSearch& target, const Pose3& start,
                              const Pose3& guess, const RegistrationOptions& options, const RegistrationPrior& prior) {
  PlanePair pair{source, target};
  const Descent descent = descend(pair, guess, options, kWideRefinement_m);
  RegistrationResult result = settled_result(pair, start, descent, options, prior);
  result.searched = true;
  if (result.converged()) result.worth = judged(pair, descent, options).worth;
  return result;
}

}  // namespace kilter
