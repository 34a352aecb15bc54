// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/pipeline/pair_schedule.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "kilter/base/lowest_failure.h"

namespace kilter {
namespace {

// Sixteen submaps stay in a large cache. Where fewer fit into memory, going to and fro inside a tile helps.
constexpr int kTile = 8;

}  // namespace

std::vector<std::size_t> order_for_reuse(std::span<const PairId> pairs) {
  std::vector<std::size_t> order(pairs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto place = [&](std::size_t i) {
    const int source = pairs[i].source.value;
    const int target = pairs[i].target.value;
    const int column = source / kTile % 2 == 0 ? target / kTile : -(target / kTile);
    return std::tuple(source / kTile, column, source, source % 2 == 0 ? target : -target);
  };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return place(a) < place(b); });
  return order;
}

Expected<void> for_each_pair(std::span<const SubmapNode> nodes, SubmapStore& store, std::span<const PairId> pairs,
                             const RunContext& run, const std::function<void(std::size_t, const PlacedPair&)>& body) {
  const std::vector<std::size_t> order = order_for_reuse(pairs);
  LowestFailure failure;
  parallel_for(order.size(), run, [&](std::size_t k) {
    if (failure.is_before(k)) return;
    const PairId id = pairs[order[k]];
    const Expected<PinnedPair> maps = store.pin(id);
    if (!maps) return failure.keep(k, maps.error());
    body(order[k], {{*maps->source, nodes[static_cast<std::size_t>(id.source.value)].T_world_submap},
                    {*maps->target, nodes[static_cast<std::size_t>(id.target.value)].T_world_submap}});
  });
  return failure.result();
}

Expected<void> for_each_submap(SubmapStore& store, std::size_t count, const RunContext& run,
                               const std::function<void(std::size_t, const SearchableMap&)>& body) {
  LowestFailure failure;
  parallel_for(count, run, [&](std::size_t i) {
    if (failure.is_before(i)) return;
    const Expected<PinnedMap> map = store.pin(SubmapId{static_cast<int>(i)});
    if (!map) return failure.keep(i, map.error());
    body(i, **map);
  });
  return failure.result();
}

}  // namespace kilter
