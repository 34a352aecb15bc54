// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "kilter/pipeline/result.h"

namespace kilter {

/// The pairs that a summary names, at most `count` >= 3 of those that are inconsistent or have an offset. Inconsistent
/// ones in a row come first, since a slip there bends everything behind it; at least one inconsistent pair of each kind
/// that has any is there. Otherwise the worst: inconsistent, then believed, then by offset.
[[nodiscard]] std::vector<const PairResult*> worst_pairs(const Result& result, std::size_t count);

/// A table of the five worst pairs for a terminal of `columns`, two lines of heading first; empty if there are none.
///
/// A row shows the RMS offset with its 95 % interval, the rotation, and the *shift*: how far the source submap would
/// have to move, at the middle of what both saw, along x, y and z of the world frame, to lie where registration finds
/// it (offset_vector turned from the target's axes by the map's pose), or that it is not known where that registration
/// is not believed. The rotation has a sign, + to the left, where it is known and mostly about the world's z.
/// \param papers_test  verdicts rest on Gamma alone, which takes registration as it is
[[nodiscard]] std::vector<std::string> worst_pair_lines(const Result& result, bool papers_test, std::size_t columns);

}  // namespace kilter
