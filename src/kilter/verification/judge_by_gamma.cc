// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <optional>
#include <string>
#include <utility>

#include "kilter/verification/judge.h"
#include "kilter/verification/judge_notes.h"
#include "kilter/verification/offset.h"

namespace kilter {
namespace {

// Of one or two values each is in line with their median.
constexpr std::size_t kFewestGammas = 3;

}  // namespace

PairVerdict judge_pair_by_gamma(const PairEvidence& pair, const MapNull& null) {
  PairVerdict verdict;
  note_measurements(pair, null, verdict);
  if (!pair.overlaps || !pair.map.score) {
    verdict.reason = pair.gate;
    return verdict;
  }
  const std::optional<double> gamma = pair.map.score->log10_gamma;
  const double limit = null.log10_gamma - kThetaSpreads * null.log10_gamma_spread;
  const std::string test = gamma ? fmt::format("log10 Gamma {:.2f} is {} this map (from {:.2f})", *gamma,
                                               *gamma >= limit ? "in line with" : "low for", limit)
                                 : std::string("Gamma is infinite: all distances are equal or zero");
  if (const std::string failure = registration_failure(pair); !failure.empty()) {
    verdict.reason = fmt::format("{}; {}", failure, test);
    return verdict;
  }
  verdict.unobservable = pair.registration->unobservable;
  if (!pair.registered->score) {
    verdict.reason = fmt::format("registration failed: it ended where too few voxels match; {}", test);
    return verdict;
  }
  const OffsetEstimate offset = estimate_offset(*pair.registration, pair.T_target_source);
  verdict.offset_m = offset.offset_m;
  verdict.offset_rad = offset.offset_rad;
  verdict.offset_vector_m = offset.vector_m;
  if (null.pairs < kFewestGammas) {
    verdict.reason =
        fmt::format("Gamma has no scale of its own, and {} registered {} too few to compare it with ({} would do)",
                    null.pairs, null.pairs == 1 ? "pair is" : "pairs are", kFewestGammas);
    return verdict;
  }
  const std::optional<double> theta = pair.registered->score->log10_gamma;
  const std::string reached = theta ? fmt::format("{:.2f}", *theta) : std::string("infinity");
  if (!gamma || *gamma >= limit) {
    verdict.verdict = Verdict::kConsistent;
    verdict.reason = test;
  } else if (theta && *theta - *gamma >= kThetaSlack && offset.offset_m > pair.grain.edge_m) {
    verdict.verdict = Verdict::kInconsistent;
    verdict.reason = fmt::format("{}, registered {}: verified", test, reached);
  } else {
    verdict.reason = fmt::format("{}, but registration does not verify it: it reaches {}", test, reached);
  }
  if (verdict.verdict == Verdict::kUnverified) return verdict;
  if (std::string against = doubt_of_rivals(pair); !against.empty()) {
    verdict.without_registration = std::move(against);
  } else if (verdict.verdict == Verdict::kConsistent && offset.offset_m > pair.grain.edge_m) {
    verdict.without_registration = "Gamma is of the map's pose, and registration left it";
  }
  return verdict;
}

}  // namespace kilter
