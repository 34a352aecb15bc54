// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <deque>
#include <span>

#include "kilter/base/expected.h"
#include "kilter/base/parallel.h"
#include "kilter/pipeline/measure_pair.h"
#include "kilter/pipeline/submap_store.h"
#include "kilter/submap/submap.h"

namespace kilter {

/// What came of all candidates.
struct MeasuredPairs {
  std::deque<PairMeasurement> listed;  ///< in the candidates' order
  std::size_t left_out = 0;            ///< candidates that are not listed
};

/// Measures every candidate and keeps those that are listed: of the others, which may be a hundred times as many, it
/// holds a pointer each. Options must be `resolved`. Same bits for any number of threads. Incomplete once a stop is
/// requested. \return what the store failed with.
[[nodiscard]] Expected<MeasuredPairs> measure_pairs(std::span<const SubmapNode> nodes,
                                                    std::span<const CandidatePair> candidates,
                                                    const CheckOptions& options, SubmapStore& store,
                                                    const RunContext& run);

}  // namespace kilter
