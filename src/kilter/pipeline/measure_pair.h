// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>

#include "kilter/pairing/propose_pairs.h"
#include "kilter/pipeline/check.h"
#include "kilter/pipeline/pair_schedule.h"
#include "kilter/pipeline/result.h"
#include "kilter/pipeline/searchable_map.h"
#include "kilter/verification/judge.h"

namespace kilter {

/// The options with what several stages share copied from the one key that holds it.
[[nodiscard]] CheckOptions resolved(CheckOptions options);

/// The searches that measure_pair makes, whatever the pair. Options must be `resolved`.
[[nodiscard]] SearchSetup search_setup(const CheckOptions& options);

/// One pair, measured at the map's pose and, if it overlaps there, registered and measured again.
struct PairMeasurement {
  /// False for a candidate that overlaps enough neither at the map's pose nor at any pose within the drift allowance:
  /// it is counted, and nothing else of it was measured. Sequential pairs are always listed.
  bool listed = true;
  CandidatePair candidate;
  PairEvidence evidence;
  std::size_t matched = 0;  ///< source voxels matched at the map's pose
  double overlap = 0.0;     ///< of the source voxels inside the target's box, the fraction matched there
  std::optional<DistanceHistogram> histogram;  ///< at the map's pose
  std::optional<double> theta_oicp_per_m3;
};

/// Algorithm 1's inner step. Options must be `resolved`. Pure: same bits for any thread.
[[nodiscard]] PairMeasurement measure_pair(const PlacedPair& maps, const CandidatePair& pair,
                                           const CheckOptions& options);

/// The pair's evidence had registration started from another pose. Options must be `resolved`.
[[nodiscard]] PairEvidence register_again(const PlacedPair& maps, const PairMeasurement& before,
                                          const Pose3& T_target_source_guess, const CheckOptions& options);

/// What the outside hears of it.
[[nodiscard]] PairResult pair_result(const PairMeasurement& measurement, const PairVerdict& verdict,
                                     const CheckOptions& options);

}  // namespace kilter
