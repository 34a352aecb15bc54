// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "kilter/base/option_table.h"
#include "kilter/base/parallel.h"
#include "kilter/pairing/coarse_overlap.h"
#include "kilter/submap/submap.h"

namespace kilter {

/// Which submaps could show the same place, and so must be compared.
struct PairingOptions {
  int local_min_gap = 2;          ///< the paper's k: (i, j) of one robot is a local pair from i - j = k on
  double drift_per_metre = 0.01;  ///< how far a pose may have drifted for each metre travelled. [m/m]
  double drift_max_m = 10.0;      ///< no more than this is allowed for. [m]
  double max_distance_m = 1.0;    ///< boxes are widened by the paper's d. [m]
  double overlap_min = 0.15;      ///< predicted overlap that is enough
  int matched_min = 200;          ///< predicted matches that are enough
};

[[nodiscard]] std::vector<OptionField> fields(PairingOptions& options);

/// A pair that could show one place.
struct CandidatePair {
  PairId id;
  PairKind kind = PairKind::kSequential;
  double drift_allowance_m = 0.0;  ///< how far the true relative position may be from the map's. [m]
  double predicted_overlap = 0.0;  ///< best coarse overlap within the allowance, 0..1
  bool predicted_enough = false;   ///< that overlap, and the matches it promises, pass the gates
  /// Shift of the source, in the target's frame, at which the best coarse overlap was found. [m]
  Eigen::Vector3d predicted_shift_m = Eigen::Vector3d::Zero();
};

/// Cells of a CoarseMap that are enough to predict an overlap.
inline constexpr std::size_t kMaxCoarseCells = 256;

/// How far apart the truth of two submaps may be from what the map says: drift_per_metre times the path between them
/// (one robot) or the sum of both paths from their starts (two robots), at most drift_max_m. [m]
[[nodiscard]] double drift_allowance_m(const SubmapNode& source, const SubmapNode& target,
                                       const PairingOptions& options);

/// Finds sequential (i, i-1), local (i, j <= i - k) and global (b, a) pairs (Eq. 4-6) whose boxes, widened by d and
/// the drift allowance, touch.
/// \param maps  how each submap looks from afar, in the order of the nodes; see kMaxCoarseCells.
/// \return sorted by PairId, nothing predicted yet; every sequential pair is among them, boxes touching or not.
/// O(N log N + pairs).
[[nodiscard]] std::vector<CandidatePair> meeting_pairs(std::span<const SubmapNode> nodes,
                                                       std::span<const CoarseMap> maps, const PairingOptions& options);

/// The same, and says how much their coarse occupancy (one block of 8 voxels a cell) would overlap at the best
/// horizontal shift within the allowance. Deterministic.
[[nodiscard]] std::vector<CandidatePair> propose_pairs(std::span<const SubmapNode> nodes,
                                                       std::span<const CoarseMap> maps, const PairingOptions& options,
                                                       const RunContext& run);

}  // namespace kilter
