// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/verification/judge_notes.h"

#include <fmt/format.h>

namespace kilter {
namespace {

constexpr double kOnePercent = 2.5758;  // standard deviations that chance exceeds once in a hundred, either side

}  // namespace

void note_measurements(const PairEvidence& pair, const MapNull& null, PairVerdict& verdict) {
  if (pair.map.score && pair.map.score->log10_gamma) {
    verdict.evidence["log10_gamma"] = {pair.map.score->log10_gamma, null.log10_gamma, std::nullopt};
  }
  if (pair.gap) {
    verdict.gap_m = pair.gap->gap_m;
    verdict.evidence["gap_m"] = {pair.gap->gap_m, kOnePercent * pair.gap->sigma_m, std::nullopt};
  }
  if (pair.map.matched > 0) verdict.evidence["mean_distance_m"].value = pair.map.mean_distance_m;
  if (pair.common) verdict.evidence["same_side"].value = pair.common->overlap;
  if (pair.map.conflict.known() > 0) {
    verdict.evidence["conflict"] = {pair.map.conflict.share(), null.conflict, std::nullopt};
  }
  if (pair.registered) {
    verdict.evidence["mean_distance_m"].null = pair.registered->mean_distance_m;
    if (pair.registered->conflict.known() > 0) {
      verdict.evidence["conflict_registered"] = {pair.registered->conflict.share(), null.conflict, std::nullopt};
    }
  }
}

std::string registration_failure(const PairEvidence& pair) {
  if (!pair.registration) return "registration failed: not tried";
  if (pair.registration->converged() && pair.registered) return {};
  return fmt::format("registration failed: {}", to_string(pair.registration->stop));
}

}  // namespace kilter
