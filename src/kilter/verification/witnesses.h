// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kilter/verification/judge.h"

// What tells whether a move is worth it, and what speaks against the map's pose where no registration is believed to be
// right. The pieces of judge_pair.
namespace kilter {

/// A displacement of this p-value needs no other witness, and may vouch for others.
inline constexpr double kSurely = 1e-4;

/// Only keeps numbers finite: log odds rank pairs whose probability has long come out as 1.
inline constexpr double kMaxLogOdds = 1e6;

/// Whether more voxels that face the way moved fit at the registered pose than at the map's, beyond chance; fewer are
/// enough where conflict vanishes, many are asked for where it grows a little, and none are enough where it grows by
/// more. Precondition: the pair was registered.
[[nodiscard]] bool fit_improved(const PairEvidence& pair);

/// Whether no free space can speak of the registered pose: points alone, or nothing that both know.
[[nodiscard]] inline bool free_space_is_unknown(const PairEvidence& pair) {
  return pair.registered->conflict.known() == 0;
}

/// Whether clearly more of what both saw conflicts at the registered pose than at the map's. Precondition: as above.
[[nodiscard]] bool conflict_grew(const PairEvidence& pair);

/// Whether less than half of the voxels show a side that both saw, and hardly anything stands in space that the other
/// submap saw through, no more than in other pairs of the map: what lies apart would. False where too little is known.
[[nodiscard]] bool free_space_is_silent(const PairEvidence& pair, const MapNull& null);

/// Makes `log_odds` and `p_inconsistent` of a log likelihood ratio and the prior.
void set_posterior(double log_ratio, const JudgeOptions& options, PairVerdict& verdict);

/// Free space as a witness of its own: for pairs of different places, for submaps that are bent beyond what a rigid
/// motion mends, for a motion that mends much but may not be the right one. Sets p_value and `without_registration` if
/// it says more than the verdict so far.
void let_free_space_speak(const PairEvidence& pair, const MapNull& null, const JudgeOptions& options,
                          PairVerdict& verdict);

/// The same for a pair that was moved by more than the tolerance, which its neighbours contradict: they ask for another
/// correction, and do not say that none is needed. Where the wide search left the map's pose for one that fits better,
/// that pose is wrong, whichever is right, unless free space speaks against the move: then it is the storey above.
/// \param p_value  of the displacement, were it believed
void let_better_fit_speak(const PairEvidence& pair, double p_value, PairVerdict& verdict);

/// A right pose is denied by believed neighbours this seldom at most: upper 95 % bound over the good pairs of
/// `benchmarks/accuracy/run`, of which none was (most are in maps where nobody could be heard).
inline constexpr double kDeniedByNeighbours = 0.002;

/// Whether enough of its neighbours, believed on their own, vouch for the move that registration found.
[[nodiscard]] bool is_vouched_for(const PairEvidence& pair);

/// The same for a pair that was moved by more than the tolerance and is doubted, where its neighbours vouch for the
/// move (the caller's to ask): what may mislead one pair does not mislead those. \param p_value  of the displacement,
/// were it believed
void let_neighbours_speak(const PairEvidence& pair, double p_value, PairVerdict& verdict);

/// The same for a pair that was not registered, where those around it would move it.
void let_movers_speak(const PairEvidence& pair, const JudgeOptions& options, PairVerdict& verdict);

}  // namespace kilter
