// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kilter/base/option_table.h"
#include "kilter/consistency/distribution.h"
#include "kilter/consistency/gamma.h"
#include "kilter/matching/conflict.h"
#include "kilter/matching/pair_grain.h"
#include "kilter/matching/parallel_gap.h"
#include "kilter/registration/registration.h"
#include "kilter/verification/agreement.h"
#include "kilter/verification/verdict.h"

namespace kilter {

/// What a verdict rests on.
enum class JudgeMethod {
  kDisplacement,  ///< how far registration moves the pair, against the tolerance
  kGamma,         ///< the paper's numbers alone: Gamma against the map's own, Theta to verify
};

/// What a pair or a map has to show for a verdict.
struct JudgeOptions {
  JudgeMethod method = JudgeMethod::kDisplacement;
  double tolerance_m = 0.1;          ///< disagreement that the user can live with. [m]
  double alpha = 0.01;               ///< false-discovery level of `inconsistent` over the map
  double prior_inconsistent = 0.05;  ///< share of pairs believed inconsistent before looking
  double min_decided = 0.5;          ///< of the overlapping pairs of each kind and each two robots
};

[[nodiscard]] std::vector<OptionField> fields(JudgeOptions& options);

/// The pair at one relative pose.
struct PoseEvidence {
  std::optional<PairScore> score;  ///< Gamma's or Theta's; absent below the gate
  std::size_t matched = 0;         ///< the smaller of both ways
  double overlap = 0.0;            ///< the larger of both ways
  double mean_distance_m = 0.0;    ///< mean of d_e over the matched voxels, both ways
  ConflictSample conflict;
  std::optional<DistanceHistogram> histogram = {};  ///< of the distances, to be shown; absent when nothing matched
};

/// What both submaps show from the same side, at the map's pose: voxels with one of the other's that faces the same way
/// within the conflict's margin. Floors and the ceilings below them, or the two sides of a wall, match within the
/// paper's d and have none.
struct CommonSurface {
  std::size_t matched = 0;  ///< the smaller of both ways
  double overlap = 0.0;     ///< the larger of both ways
  bool any = false;         ///< as many as the gate on matched voxels asks for
  bool enough = false;      ///< passes both gates
};

/// All that was measured on one pair.
struct PairEvidence {
  PairId id;
  PairKind kind = PairKind::kSequential;
  bool overlaps = false;           ///< passes the gates on matched count and fraction at the map's pose
  std::string gate;                ///< what fails, if it does not overlap
  Pose3 T_target_source;           ///< the map's
  PairGrain grain;                 ///< how finely their surfaces can be told apart
  double conflict_margin_m = 0.2;  ///< a surface of the other's this near is the same to free space
  PoseEvidence map;
  std::optional<CommonSurface> common;             ///< absent where points alone leave open which way surfaces face
  std::optional<ParallelGap> gap;                  ///< at the map's pose
  std::optional<RegistrationResult> registration;  ///< absent if it was not tried
  std::optional<PoseEvidence> registered;          ///< absent if it did not converge
  Agreement agreement;                             ///< with the registrations around it, once they were compared
};

/// What pairs of this map look like when nothing is wrong: medians over the sequential pairs, which survive a fifth of
/// bad ones; over all pairs where fewer than two sequential ones were registered.
struct MapNull {
  double log10_gamma = 0.0;         ///< at the map's pose
  double log10_gamma_spread = 0.0;  ///< 1.4826 times the median absolute deviation
  double log10_theta = 0.0;         ///< once registered
  double log10_theta_spread = 0.0;  ///< 1.4826 times the median absolute deviation
  /// Lower quartile, over all pairs, of the share that conflicts once registered; 0.03 at most where they are few.
  double conflict = 0.0;
  double conflict_spread = 0.0;
  std::size_t pairs = 0;            ///< how many stand behind log10_gamma
  std::size_t pairs_with_free = 0;  ///< and behind conflict
};

/// From the pairs that were registered; 0 is what none of them tells.
[[nodiscard]] MapNull estimate_null(std::span<const PairEvidence* const> pairs);

/// First judge: the displacement found by registration against the tolerance, believed only if registration made the
/// pair agree better and left no more conflict than other pairs of the map show (steps F10-F12). Where it cannot be
/// believed, free space, a pose that fits better or believed neighbours may still say that the map's is wrong.
/// `inconsistent` is decided later, over the map, by judge_map: until then such pairs are kUnverified with a small
/// p_value.
[[nodiscard]] PairVerdict judge_pair(const PairEvidence& pair, const MapNull& null, const JudgeOptions& options);

/// What a verdict says of the correction that its pair's registration asks for, to those around it. \param verdict  by
/// judge_pair
[[nodiscard]] Standing standing_of(const PairVerdict& verdict, const JudgeOptions& options);

/// Whether one rigid motion mends a pair: its bend leaves no more than the tolerance apart. Whatever the judge.
[[nodiscard]] bool is_rigid(const RegistrationResult& registration, const JudgeOptions& options);

/// Whether the two may show different places, as the map has them: too little is seen by both from the same side, and
/// no more than usual of it conflicts. A double wall, or a place that is elsewhere, leaves surfaces in free space.
[[nodiscard]] bool may_show_different_places(const PairEvidence& pair, const MapNull& null);

/// The same, and next to nothing is seen by both from the same side: nothing can be compared.
[[nodiscard]] bool shows_no_common_side(const PairEvidence& pair, const MapNull& null);

/// The paper's test with the thresholds that it leaves out (step F11): a pair is out of line if log10 Gamma lies three
/// spreads below the map's median; verified inconsistent if Theta then is at least twice Gamma and registration moved
/// it by more than a voxel, or a cell if that is larger; rejected (kUnverified) if Theta is not; consistent if it is in
/// line. kUnverified whatever Gamma is if registration failed, so that there is no Theta, and where fewer than three
/// pairs say what is in line. No p-value.
[[nodiscard]] PairVerdict judge_pair_by_gamma(const PairEvidence& pair, const MapNull& null);

/// A pair as judge_map needs it.
struct JudgedPair {
  PairId id;
  PairKind kind = PairKind::kSequential;
  bool overlaps = false;  ///< undecided, it is named among what the certificate excludes
  int source_robot = 0;
  int target_robot = 0;
  PairVerdict verdict;
  bool waited_for = true;  ///< false where the two may show different places: need not be decided
};

/// Decides which pairs are inconsistent with the false-discovery level held over the map (Benjamini-Hochberg on the
/// p-values), then the map: inconsistent if any pair is; consistent if none is and, for each kind present and each two
/// robots, at least min_decided of the pairs that are waited for or were decided were; otherwise undetermined. Eq.
/// (6)-(7) as log sums. Changes the verdicts of `pairs` in place.
[[nodiscard]] MapVerdict judge_map(std::vector<JudgedPair>& pairs, std::span<const std::string> robots,
                                   const JudgeOptions& options);

}  // namespace kilter
