// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/verification/witnesses.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "kilter/numerics/special.h"

namespace kilter {
namespace {

// Registration always moves a little: a displacement counts only if this many times as many voxels support the new
// pose (face the way moved and lie within a quarter voxel of the other submap's planes) as the map's, and not by
// chance.
constexpr double kLeastGain = 1.3;
constexpr double kGainDeviations = 3.0;
// A smaller gain will do if free space agrees too: at most half of the conflict is left, and so much of what both saw
// no longer conflicts. Less will do if it is not by chance.
constexpr double kLeastGainWithFreeSpace = 1.1;
constexpr double kMuchConflictGone = 0.02;
constexpr double kLeastConflictGone = 0.002;
constexpr double kConflictLeft = 0.5;
constexpr double kVoxelsOfAThing = 10.0;  // conflicting voxels come in things, as people and chairs do
// Surfaces that lie apart stand in space that the other submap saw through, so a move in the right direction makes
// conflict vanish. Where it makes some instead, the storey above, the ceiling or the next aisle is what fits, however
// well. What moved in between conflicts either way, a little more here or there: then the gain has to be overwhelming.
// So it has where there is no free space to ask: to points alone a wall's other face is the wall.
constexpr double kLeastGainAgainstFreeSpace = 3.0;
constexpr double kConflictMayGrow = 1.5;
// What conflicts as much here as there, give or take so much, is not what tells two poses apart: of 31 moves beyond the
// tolerance with as little growth one was wrong (`benchmarks/accuracy/run`, parts drift, clean and sealed).
constexpr double kConflictStays = 1.1;
// Of what both saw, this much may have moved in between.
constexpr double kMovingShare = 0.2;
constexpr double kConflictSampling = 0.02;  // standard deviation of such a share
constexpr double kFewestKnown = 400.0;      // voxels, of both submaps, or cells, that it has to stand on
// A right pose is left this seldom for one that fits better, beyond chance, and that its neighbours contradict: upper
// 95 % bound over the good pairs of `benchmarks/accuracy/run`, of which none was.
constexpr double kLeftForBetter = 0.002;
// So many neighbours, believed on their own, have to ask for the move of a pair that is doubted.
constexpr int kVouching = 2;
constexpr int kMovers = 3;  // of one that was not registered, and asks for nothing itself

// Free space is silent at this share of what both know; where most voxels show a common side it need not speak. Of
// 8,782 pairs that are rightly called inconsistent, 18 are silent (`benchmarks/accuracy/run`).
constexpr double kSilentShare = 0.001;
constexpr double kMostlyCommon = 0.5;

bool enough_is_known(const PairEvidence& pair) {
  return static_cast<double>(pair.map.conflict.known()) >= kFewestKnown * pair.grain.voxels_per_cell;
}

// Support grew by this factor at least, and by more than two counts of such voxels may differ.
bool support_grew(const RegistrationResult& registration, double factor) {
  const auto start = static_cast<double>(registration.support_start);
  const auto end = static_cast<double>(registration.support_end);
  return end - factor * start > kGainDeviations * std::sqrt(end + factor * factor * start);
}

// What overlaps and what both saw stay when the source moves, so that what was seen there counts.
bool stays_in_view(const PairEvidence& pair) {
  const PoseEvidence& after = *pair.registered;
  const auto kept = [](double before, double now) { return now >= kOverlapKept * before; };
  return kept(pair.map.overlap, after.overlap) &&
         kept(static_cast<double>(pair.map.conflict.known()), static_cast<double>(after.conflict.known()));
}

bool half_the_conflict_goes(const PairEvidence& pair) {
  return pair.registered->conflict.share() <= kConflictLeft * pair.map.conflict.share();
}

// Conflict falls by half at least, and by much; or, in what both poses know, by more than two counts of things that
// conflict may differ.
bool conflict_went(const PairEvidence& pair) {
  const double before = pair.map.conflict.share();
  const double after = pair.registered->conflict.share();
  if (!half_the_conflict_goes(pair) || before - after < kLeastConflictGone) return false;
  if (before - after >= kMuchConflictGone) return true;
  if (!stays_in_view(pair)) return false;
  const double a_thing = kVoxelsOfAThing * pair.grain.voxels_per_cell;
  const auto variance = [&](double share, const ConflictSample& conflict) {
    return share * a_thing / static_cast<double>(conflict.known());
  };
  return before - after >
         kGainDeviations * std::sqrt(variance(before, pair.map.conflict) + variance(after, pair.registered->conflict));
}

// Half of the conflict goes when the source moves, and more fits. Things that were moved in between do not go by moving
// the submap.
bool conflict_is_mended(const PairEvidence& pair) {
  return pair.registered && half_the_conflict_goes(pair) && stays_in_view(pair) &&
         support_grew(*pair.registration, kLeastGainWithFreeSpace);
}

// How much conflict a disagreement of the tolerance may make. A surface that stands where the other submap saw through
// lies at least the conflict's margin off its counterpart, so a share s of such surfaces makes the disagreement at
// least margin * sqrt(s), whatever it looks like; and things that moved conflict, too. Where a motion mends it, it is
// not those; and displacements are then spread no wider than a normal law is, which lies beyond the margin less often.
// What the cells hide puts surfaces off on top of the disagreement.
double tolerated_conflict(const PairEvidence& pair, double tolerance_m) {
  const double margin_m = pair.conflict_margin_m;
  const double apart_m = std::hypot(tolerance_m, pair.grain.sigma_m());
  const double whatever = std::pow(apart_m / margin_m, 2);
  if (conflict_is_mended(pair)) return std::min(whatever, 2.0 * std::exp(log_normal_tail(margin_m / apart_m)));
  return std::max(whatever, kMovingShare);
}

// No registration is believed, so there is no constraint, and nothing bounds the disagreement from above.
void decide_without_registration(double p_value, std::string reason, PairVerdict& verdict) {
  verdict.p_value = p_value;
  verdict.disagreement_most_m.reset();
  verdict.without_registration = std::move(reason);
}

}  // namespace

bool conflict_grew(const PairEvidence& pair) {
  return pair.registered->conflict.share() > kConflictStays * pair.map.conflict.share();
}

bool fit_improved(const PairEvidence& pair) {
  const double before = pair.map.conflict.share();
  const double after = pair.registered->conflict.share();
  if (after > kConflictMayGrow * before) return false;
  if (free_space_is_unknown(pair) || conflict_grew(pair))
    return support_grew(*pair.registration, kLeastGainAgainstFreeSpace);
  return support_grew(*pair.registration, conflict_went(pair) ? kLeastGainWithFreeSpace : kLeastGain);
}

bool free_space_is_silent(const PairEvidence& pair, const MapNull& null) {
  return pair.common && pair.common->overlap < kMostlyCommon && enough_is_known(pair) &&
         pair.map.conflict.share() <= std::max(null.conflict, kSilentShare);
}

void set_posterior(double log_ratio, const JudgeOptions& options, PairVerdict& verdict) {
  const double prior = std::log(options.prior_inconsistent / (1.0 - options.prior_inconsistent));
  verdict.log_odds = std::clamp(log_ratio + prior, -kMaxLogOdds, kMaxLogOdds);
  verdict.p_inconsistent = 1.0 / (1.0 + std::exp(-*verdict.log_odds));
}

void let_free_space_speak(const PairEvidence& pair, const MapNull& null, const JudgeOptions& options,
                          PairVerdict& verdict) {
  if (!pair.overlaps || !enough_is_known(pair)) {
    return;
  }
  if (verdict.p_value && *verdict.p_value <= kSurely) return;
  const double excess = pair.map.conflict.share() - null.conflict;
  const double z =
      (excess - tolerated_conflict(pair, options.tolerance_m)) / std::hypot(null.conflict_spread, kConflictSampling);
  if (z <= 0.0) return;
  const double p_value = std::exp(log_normal_tail(z)) * (verdict.p_value ? 2.0 : 1.0);  // the better of two tests
  if (verdict.p_value && *verdict.p_value <= p_value) return;
  const double log_ratio = std::min(log_normal_tail(-z) - log_normal_tail(z), kMaxLogOdds);
  verdict.evidence["conflict"].log_ratio = log_ratio;
  // It only speaks against the map: what registration says of that, doubted as it may be, is not taken back.
  const auto registered = verdict.evidence.find("disagreement");
  const double said =
      registered == verdict.evidence.end() ? log_ratio : registered->second.log_ratio.value_or(log_ratio);
  set_posterior(std::max(log_ratio, said), options, verdict);
  decide_without_registration(
      p_value,
      fmt::format("{:.0f} % of what both saw conflicts as the map has it (typical of this map: {:.0f} %), and {} ({})",
                  100.0 * pair.map.conflict.share(), 100.0 * null.conflict,
                  conflict_is_mended(pair)
                      ? "a motion mends most of it, so nothing else has moved; whether it is the right one is open"
                      : "no rigid motion that can be believed mends it: the places differ, or a submap is bent",
                  verdict.reason),
      verdict);
}

void let_better_fit_speak(const PairEvidence& pair, double p_value, PairVerdict& verdict) {
  if (!stays_in_view(pair) || conflict_grew(pair) || !fit_improved(pair)) return;
  verdict.evidence["support"].log_ratio = verdict.evidence.at("disagreement").log_ratio;
  const std::string conflict =
      free_space_is_unknown(pair)
          ? std::string()
          : fmt::format(", and {:.1f} % of what both saw conflicts instead of {:.1f} %",
                        100.0 * pair.registered->conflict.share(), 100.0 * pair.map.conflict.share());
  decide_without_registration(
      std::max(p_value, kLeftForBetter),
      fmt::format("another pose fits better than the map's: {} voxels that face the way there meet the other's planes "
                  "instead of {}{}; which pose is right is open ({})",
                  pair.registration->support_end, pair.registration->support_start, conflict, verdict.reason),
      verdict);
}

bool is_vouched_for(const PairEvidence& pair) { return pair.agreement.vouching >= kVouching; }

void let_neighbours_speak(const PairEvidence& pair, double p_value, PairVerdict& verdict) {
  const std::optional<double> log_ratio = verdict.evidence.at("disagreement").log_ratio;
  if (*log_ratio <= 0.0) return;
  verdict.evidence["agreeing"] = {static_cast<double>(pair.agreement.agreeing),
                                  static_cast<double>(pair.agreement.contradicting), log_ratio};
  decide_without_registration(
      std::max(p_value, kDeniedByNeighbours),
      fmt::format("{} pairs around it that are believed on their own ask for the same move; its own registration does "
                  "not suffice ({})",
                  pair.agreement.vouching, verdict.reason),
      verdict);
}

void let_movers_speak(const PairEvidence& pair, const JudgeOptions& options, PairVerdict& verdict) {
  if (pair.agreement.movers < kMovers) return;
  const double log_ratio = -std::log(kDeniedByNeighbours);
  verdict.evidence["agreeing"] = {static_cast<double>(pair.agreement.movers), 0.0, log_ratio};
  set_posterior(log_ratio, options, verdict);
  decide_without_registration(
      kDeniedByNeighbours,
      fmt::format("{} pairs around it that are believed on their own would move it by more than the tolerance, all to "
                  "the same place; itself it shows nothing ({})",
                  pair.agreement.movers, verdict.reason),
      verdict);
}

}  // namespace kilter
