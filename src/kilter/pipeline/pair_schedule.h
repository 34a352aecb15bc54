// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/base/parallel.h"
#include "kilter/pipeline/submap_store.h"
#include "kilter/submap/submap.h"

namespace kilter {

/// One side of a pair: a map, and where the mission has it.
struct PlacedMap {
  const SearchableMap& searchable;
  const Pose3& T_world_submap;
};

/// Both sides, in memory while it is worked on.
struct PlacedPair {
  PlacedMap source;
  PlacedMap target;
};

/// An order in which pairs that share a submap follow each other closely, so that few submaps have to be in memory, and
/// in the processor's cache, at a time: numbers of `pairs`, by tiles of eight sources and eight targets, row after
/// row of tiles, to and fro.
[[nodiscard]] std::vector<std::size_t> order_for_reuse(std::span<const PairId> pairs);

/// Calls `body(i, pair)` for every pairs[i], on at most `run.threads` threads, in the order for reuse, both maps held
/// by the store meanwhile. `body` must only write to what belongs to i. Stops early once a stop is requested. \return
/// what the store failed with first in that order; pairs after it may be left out then.
[[nodiscard]] Expected<void> for_each_pair(std::span<const SubmapNode> nodes, SubmapStore& store,
                                           std::span<const PairId> pairs, const RunContext& run,
                                           const std::function<void(std::size_t, const PlacedPair&)>& body);

/// The same for each submap alone.
[[nodiscard]] Expected<void> for_each_submap(SubmapStore& store, std::size_t count, const RunContext& run,
                                             const std::function<void(std::size_t, const SearchableMap&)>& body);

}  // namespace kilter
