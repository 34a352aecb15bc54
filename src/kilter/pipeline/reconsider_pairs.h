// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <span>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/base/parallel.h"
#include "kilter/pipeline/measure_pair.h"
#include "kilter/pipeline/submap_store.h"
#include "kilter/submap/submap.h"

namespace kilter {

/// Holds the registrations against each other: a pair that its neighbours contradict, that fits as well elsewhere, or
/// that was never registered, is tried again from where its best-supported neighbour would put it, and keeps what it
/// finds there if that is at least half as good. Leaves in every registered pair how many of its neighbours ask for the
/// same (`PairEvidence::agreement`). Does nothing to the paper's own registration. Deterministic.
/// \return what the store failed with.
[[nodiscard]] Expected<void> reconsider_pairs(std::span<const SubmapNode> nodes, SubmapStore& store,
                                              const CheckOptions& options, const RunContext& run,
                                              std::deque<PairMeasurement>& measured);

/// How many believed pairs around each vouch for its move, or, of pairs that were not registered but overlap as the map
/// has them or within what odometry may have drifted, would move it: left in its evidence (Agreement::vouching,
/// Agreement::movers). Does nothing to the paper's own registration. \param standings  of `measured`, in order, before
/// anybody was heard
void hear_neighbours(std::span<const SubmapNode> nodes, std::span<const Standing> standings,
                     const CheckOptions& options, std::deque<PairMeasurement>& measured);

/// Each pair alone, then those once more whose neighbours, believed alone, have something to say (`hear_neighbours`).
/// \return the verdicts, in order of `measured`.
[[nodiscard]] std::vector<PairVerdict> judge_among_neighbours(std::span<const SubmapNode> nodes, const MapNull& null,
                                                              const CheckOptions& options,
                                                              std::deque<PairMeasurement>& measured);

}  // namespace kilter
