// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "kilter/matching/pair_grain.h"
#include "kilter/registration/common_places.h"
#include "kilter/registration/normal_equations.h"
#include "kilter/registration/plane_matches.h"

namespace kilter {

/// How the parts of an aligned pair's overlap that move apart were told from each other.
enum class BendKind {
  kSpace,   ///< by place, since neither knows when it saw what: one of the two is bent
  kSource,  ///< by time: it is the source that slipped or drifted inside, or it did so more
  kTarget,  ///< by time: the target
};

/// How far parts of an aligned pair still lie apart, because a submap is bent or holds a slip: no rigid motion mends
/// it.
struct Bend {
  double rms_m = 0.0;        ///< RMS of the remaining displacement: by time, over places. [m]
  double variance_m4 = 0.0;  ///< of its square
  BendKind kind = BendKind::kSpace;
  int parts = 0;  ///< of the overlap that were looked at on their own
  /// What the parts' motions have in common, as (v, w) about `centre_m`, target axes: the rigid motion on top of the
  /// aligned pose that leaves the least apart. Zero where parts are of kind kSpace.
  Vector6 common = Vector6::Zero();
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  /// Share of its square that rigid submaps would show as well. Of `common`, as much is not believed; rms_m is what is
  /// left after all of it.
  double noise_share = 0.0;
  /// What both saw, target frame: common_places() where one of the two knows times, else where residuals lie.
  PlaceMoments places{};
};

/// What can be asked of an aligned pair once motions in time are known. Both may be missing: then residuals stay those
/// that the aligned pose finds, and places are where these lie.
struct PairInMotion {
  /// The residuals once more, matched where motions put the source's places: residuals without the motions, of the
  /// planes that are near with them. On a wall that is the same plane, on a trunk or a pole another.
  std::function<std::vector<PlaneResidual>(const MotionOfPlace&)> rematch;
  /// All places that both saw, by the motions (common_places).
  std::function<std::vector<CommonPlace>(const MotionsInTime&)> find_places;
};

/// By when the two submaps saw what they share (bend_in_time), where one of them knows; otherwise, and where only one
/// does, by place: the overlap is cut into up to eight parts, each of which finds its own small motion by robust least
/// squares on the residuals' planes with a kernel that narrows from half the reach to a voxel, along the directions
/// that the part itself fixes; nothing along the others. A motion counts where it makes more of the part's residuals
/// vanish, as far as those outnumber the ones that it brings up: clutter, which no motion mends, and what only one of
/// the two saw fit elsewhere as well, by chance. The parts show the mean, weighted by their residuals, of x^T M x (see
/// OffsetEstimate) less what the motions' covariances alone would give. Of the two ways, the one that shows more is
/// told.
///
/// \param residuals  all within reach at the aligned pose, with the planarity as weight
/// \param grain      what its cells hide is no bend
/// \param in_motion  for bends in time
/// Cost: some twenty passes over the residuals, two times what it takes to match them, and common_places().
[[nodiscard]] Bend measure_bend(std::span<const PlaneResidual> residuals, const PairGrain& grain, double reach_m,
                                const PairInMotion& in_motion = {});

/// Voxels of each submap that a bend is asked of.
inline constexpr std::size_t kBendPoints = 8000;

/// The same of a pair that is aligned at this pose. `residuals` are match_planes() of kBendPoints there.
[[nodiscard]] Bend measure_bend(PlanePair& pair, const Pose3& T_target_source, double reach_m,
                                std::span<const PlaneResidual> residuals);

}  // namespace kilter
