// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/pipeline/measure_pairs.h"

#include <memory>
#include <utility>
#include <vector>

#include "kilter/pipeline/pair_schedule.h"

namespace kilter {

Expected<MeasuredPairs> measure_pairs(std::span<const SubmapNode> nodes, std::span<const CandidatePair> candidates,
                                      const CheckOptions& options, SubmapStore& store, const RunContext& run) {
  std::vector<PairId> ids;
  ids.reserve(candidates.size());
  for (const CandidatePair& pair : candidates) ids.push_back(pair.id);
  std::vector<std::unique_ptr<PairMeasurement>> measured(candidates.size());
  const Expected<void> done = for_each_pair(nodes, store, ids, run, [&](std::size_t i, const PlacedPair& maps) {
    PairMeasurement pair = measure_pair(maps, candidates[i], options);
    if (pair.listed) measured[i] = std::make_unique<PairMeasurement>(std::move(pair));
  });
  if (!done) return pass_up(done.error());
  MeasuredPairs pairs;
  for (std::unique_ptr<PairMeasurement>& pair : measured) {
    if (pair == nullptr) continue;
    pairs.listed.push_back(std::move(*pair));
    pair.reset();  // one by one, so that never all are there twice
  }
  pairs.left_out = candidates.size() - pairs.listed.size();
  return pairs;
}

}  // namespace kilter
