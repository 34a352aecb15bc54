// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/verification/judge_notes.h"

#include <fmt/format.h>

#include <optional>

#include "kilter/verification/witnesses.h"

namespace kilter {
namespace {

constexpr double kOnePercent = 2.5758;  // standard deviations that chance exceeds once in a hundred, either side

}  // namespace

void note_measurements(const PairEvidence& pair, const MapNull& null, PairVerdict& verdict) {
  const auto known = [](double value, std::size_t pairs) { return pairs > 0 ? std::optional(value) : std::nullopt; };
  const std::optional<double> typical_conflict = known(null.conflict, null.pairs_with_free);
  if (pair.map.score && pair.map.score->log10_gamma) {
    verdict.evidence["log10_gamma"] = {pair.map.score->log10_gamma, known(null.log10_gamma, null.pairs), std::nullopt};
  }
  if (pair.gap) {
    verdict.gap_m = pair.gap->gap_m;
    verdict.evidence["gap_m"] = {pair.gap->gap_m, kOnePercent * pair.gap->sigma_m, std::nullopt};
  }
  if (pair.map.matched > 0) verdict.evidence["mean_distance_m"].value = pair.map.mean_distance_m;
  if (pair.common) verdict.evidence["same_side"].value = pair.common->overlap;
  if (pair.map.conflict.known() > 0) {
    verdict.evidence["conflict"] = {pair.map.conflict.share(), typical_conflict, std::nullopt};
  }
  if (pair.registered) {
    verdict.evidence["mean_distance_m"].null = pair.registered->mean_distance_m;
    if (pair.registered->conflict.known() > 0) {
      verdict.evidence["conflict_registered"] = {pair.registered->conflict.share(), typical_conflict, std::nullopt};
    }
  }
}

// Neighbours beyond a slip rightly ask for something else, so a few that agree are enough where free space would speak
// against the wrong aisle. Where there is none, those that fell into the same aisle are easily a few.
bool contradicted(const PairEvidence& pair) {
  const Agreement& agreement = pair.agreement;
  return pair.registration->searched &&
         (agreement.contradicted() || (free_space_is_unknown(pair) && agreement.contradicting > agreement.agreeing));
}

std::string doubt_of_rivals(const PairEvidence& pair) {
  const RegistrationResult& registration = *pair.registration;
  const Agreement& agreement = pair.agreement;
  if (contradicted(pair)) {
    return fmt::format(
        "of the {} registrations around it that could tell, {} ask for another correction: it may have settled in the "
        "wrong place",
        agreement.agreeing + agreement.contradicting, agreement.contradicting);
  }
  // A wide search knows its runner-up; of what neighbours suggested only they can tell whether it is the right one.
  if (registration.suggested() && agreement.agreeing == 0) {
    return "it was found where a neighbour's correction would put it, and no registration around it confirms it";
  }
  if (registration.ambiguous() && agreement.agreeing < kSupported) {
    const Eigen::Vector3d& here_m = registration.centre_target_m;
    const Pose3 to_rival = registration.T_target_source_runner_up * registration.T_target_source.inverse();
    return fmt::format("ambiguous: {:.1f} m from there it fits {:.0f} % as well", (to_rival * here_m - here_m).norm(),
                       100.0 * *registration.ambiguity);
  }
  return {};
}

std::string registration_failure(const PairEvidence& pair) {
  if (!pair.registration) return "registration failed: not tried";
  if (pair.registration->converged() && pair.registered) return {};
  return fmt::format("registration failed: {}", to_string(pair.registration->stop));
}

}  // namespace kilter
