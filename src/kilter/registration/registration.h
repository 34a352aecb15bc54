// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "kilter/base/option_table.h"
#include "kilter/geometry/pose3.h"
#include "kilter/matching/nearest_voxel.h"
#include "kilter/registration/bend.h"
#include "kilter/registration/common_places.h"

namespace kilter {

enum class RegistrationMethod {
  kPointToPlane,  ///< voxel centroids against the planes through the closest centroids
  kOicp,          ///< the seed's reference [4] as far as it is known: point to point, occupancy-weighted, trimmed
};

/// How a pair is aligned.
struct RegistrationOptions {
  RegistrationMethod method = RegistrationMethod::kPointToPlane;
  int max_iterations = 80;
  int min_matches = 200;            ///< fewer correspondences, or fewer that fit at the end, are kTooFewMatches
  double search_distance_m = 1.0;   ///< correspondences of the first iterations may be this far. [m]
  double max_rotation_rad = 0.55;   ///< more than this from the start is refused. [rad]
  int max_points = 6000;            ///< voxels of each submap used while iterating, up to twice as many; not OICP
  bool always_search = false;       ///< run the wide search even where the local one can be trusted; not a key
  double wide_translation_m = 5.0;  ///< how far the wide search looks, or the prior's if that is more; 0 = never. [m]
};

[[nodiscard]] std::vector<OptionField> fields(RegistrationOptions& options);

/// Of the overlap at the map's pose, a fit that keeps less found something else.
inline constexpr double kOverlapKept = 0.8;

enum class StopReason {
  kConverged,
  kMaxIterations,  ///< still moving when iterations ran out
  kTooFewMatches,  ///< correspondences, or those that fit, fell below min_matches
  kOverlapLost,    ///< the aligned pair overlaps by over a fifth less than before
  kOutOfRange,     ///< moved farther than the start can be wrong
  kDegenerate,     ///< no direction is fixed by the scene
};

[[nodiscard]] std::string_view to_string(StopReason reason);

/// What is believed before looking: how far the start may be off. Sets the range of the search and the variance of
/// directions that the scene does not fix.
struct RegistrationPrior {
  double translation_m = 1.0;
  double rotation_rad = 0.1;
  Eigen::Vector3d up_target = Eigen::Vector3d::UnitZ();  ///< the vertical in the target's frame, for the wide search
};

/// The aligned pose of one pair and how well it is known.
struct RegistrationResult {
  StopReason stop = StopReason::kTooFewMatches;
  Pose3 T_target_source;  ///< the start, if nothing was aligned
  /// Where most surfaces meet. The same but where a submap is bent beyond noise: then T_target_source leaves the least
  /// apart of all that both saw, as a pose graph wants it, and here some of it meets. In between, the share of the step
  /// is taken by which the bend's square exceeds noise (Bend::noise_share).
  Pose3 T_target_source_closest;
  int iterations = 0;
  std::size_t matches = 0;      ///< correspondences at the end, of all voxels: mean of both ways; OICP: those it keeps
  double residual_rms_m = 0.0;  ///< robust-weighted, at the end. [m]
  /// Correspondences within a quarter voxel of their plane, of voxels that face the way from start to end (within 66
  /// degrees), both ways, at the start and at the end: what the move has gained. OICP: all voxels of the source within
  /// half a voxel of their point.
  std::size_t support_start = 0;
  std::size_t support_end = 0;
  /// Row-major meaning: T_target_source * Exp(xi), xi = (x y z rx ry rz) in the source's frame. Directions that the
  /// scene does not fix hold the prior's variance.
  Matrix6 covariance = Matrix6::Zero();
  Eigen::Vector3d centre_target_m = Eigen::Vector3d::Zero();  ///< middle of the matched voxels, target frame
  double place_m = kPlace_m;                                  ///< edge of a place (place_edge_m), for what is bent. [m]
  /// Mean of (p - centre) and of (p - centre)(p - centre)^T over the places that both saw (common_places; places_of
  /// where times are unknown), target axes. [m, m^2]
  Eigen::Vector3d places_arm_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d scatter_m2 = Eigen::Matrix3d::Zero();
  /// The same uncertainty as (v, w): p -> c + Exp(w) (p - c) + v about the centre c, target axes; and the part of it
  /// that was measured, zero along unobservable directions.
  Matrix6 covariance_centre = Matrix6::Zero();
  Matrix6 covariance_measured = Matrix6::Zero();
  /// The part of the measured one that comes from cells, where points are their centres (PairGrain); else zero.
  Matrix6 covariance_cells = Matrix6::Zero();
  /// Unit twists about the middle of the places, centre_target_m + places_arm_m, along the target's axes, that the
  /// scene does not fix. (covariance_centre and its parts are about centre_target_m.)
  std::vector<Vector6> unobservable;
  Bend bend;  ///< what still lies apart at the end, as far as planes at most search_distance_m from each other tell
  /// Not found from the map's pose but by the wide search, or where another pair's correction would put it.
  bool searched = false;
  /// Voxels that a plane supports where the search ended, before it settles, less what free-space conflict costs: what
  /// the wide search ranks poses by, where that of the map's own basin counts for a fifth more. Known where that or
  /// align_near ran.
  double worth = 0.0;
  /// Worth (support less conflict) of the next best distinct pose as a share of the best, where the wide search found
  /// one (no slide along a corridor): near 1, the pair fits as well elsewhere. Absent if that search did not run.
  std::optional<double> ambiguity;
  Pose3 T_target_source_runner_up;  ///< that pose; meaningful with `ambiguity`

  /// Another pose fits nearly as well.
  [[nodiscard]] bool ambiguous() const { return ambiguity.value_or(0.0) > 0.7; }
  /// Found where another pair's correction would put it (align_near): what else might fit was not looked for.
  [[nodiscard]] bool suggested() const { return searched && !ambiguity; }
  [[nodiscard]] bool converged() const { return stop == StopReason::kConverged; }
};

/// Aligns the source to the target, starting from the map's relative pose: local search only.
///
/// \param source, target  searches over centroids for point-to-plane; over the seed's positions for OICP.
/// Never fails with an error: a registration that did not work says so in `stop`. Deterministic.
[[nodiscard]] RegistrationResult align_submaps(const NearestVoxelSearch& source, const NearestVoxelSearch& target,
                                               const Pose3& T_target_source_start, const RegistrationOptions& options,
                                               const RegistrationPrior& prior);

}  // namespace kilter
