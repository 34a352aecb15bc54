// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "kilter/registration/bend.h"
#include "kilter/registration/normal_equations.h"

namespace kilter {

/// Which of the two submaps knows what it saw earlier and what later.
struct TimesKnown {
  bool source = false;
  bool target = false;
};
[[nodiscard]] TimesKnown times_known(std::span<const PlaneResidual> residuals);

/// The bend where each submap lies off by a motion that changes with time. Both times are cut into twelve; what the
/// source saw in its a-th and the target in its b-th still has to move by x_a - y_b to meet, six numbers each. All 24
/// motions are solved for at once, since a place that one submap saw early the other may have seen late:
///
///     sum w (r + J (x_a - y_b))^2 + sum |x_a - x_{a-1}|^2 / q_a + sum |y_b - y_{b-1}|^2 / q_b + weak ties to zero
///
/// The weights are a Geman-McClure kernel's, which narrows from half the reach to a voxel, and such that a patch of
/// surface counts as one observation. A submap drifts from one twelfth to the next, by little and by much where it
/// slips: a Student law of one degree of freedom, by weights q made anew in each round, its scale a fifth of the
/// kernel's. So a twelfth that saw nothing but floor lies, along it, where its neighbours do, and what only one of the
/// two saw is outvoted. Then places are matched anew, twice, where the motions put them: trunks and poles would
/// otherwise pull towards whichever side of them was near at the aligned pose, and a bend seem smaller than it is. What
/// the motions leave apart is asked of all places that both saw, most of which fix nothing: of what was seen once, far
/// away or in leaves, hardly any residuals come, and there a turn moves the most.
///
/// \return what is left once the one motion that leaves the least apart is taken out, and that motion. Each place
///         counts once.
/// Cost: sixteen passes over the residuals, each with a Cholesky factor of 144 unknowns, matching them twice, and
/// finding the places.
[[nodiscard]] Bend bend_in_time(std::span<const PlaneResidual> residuals, const PairGrain& grain, double reach_m,
                                const PairInMotion& in_motion);

}  // namespace kilter
