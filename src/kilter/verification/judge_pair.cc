// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "kilter/numerics/special.h"
#include "kilter/verification/judge.h"
#include "kilter/verification/judge_notes.h"
#include "kilter/verification/offset.h"
#include "kilter/verification/witnesses.h"

namespace kilter {
namespace {

// Equivalence is claimed when the posterior leaves this much for a disagreement above the tolerance.
constexpr double kConsistentTail = 0.05;
// Conflict this many spreads above the map's own good pairs, and never below these shares, is out of line.
constexpr double kConflictSpreads = 4.0;
constexpr double kConflictSlack = 0.03;
// A registration that is not believed is the wrong one this often, where it ended within the tolerance. It then says
// nothing of the disagreement, so likelihood ratios are bounded by the inverse of this.
constexpr double kWrongWhenDoubted = 0.25;
// It starts at the map's pose, and a wide search leaves that basin for a better one only: from a right pose it ends
// beyond the tolerance this much more rarely than from a wrong one, doubted or not, as long as conflict does not grow
// on the way; where it does, as in the storey above, right poses are left as often. Of pairs off by more than the
// tolerance 24 % are doubted and ended beyond it, of the others 0.05 % (2 of 3,879), which is a ratio of 465, 128 to
// 3,840 with 95 % (`benchmarks/accuracy/run --parts drift`).
constexpr double kLeavesRightPlace = 0.0025;
// Points alone do not show when they were seen, nor what free space says of them: of pairs off by more than the
// tolerance, so many look as if they were off by less, because a submap is bent inside (66 of 1,322, see
// `benchmarks/accuracy/run --parts points --seeds 1-6`). A ratio says no more than that for a pair of theirs.
constexpr double kBentUnseen = 0.05;

double conflict_limit(const MapNull& null) {
  return null.conflict + std::max(kConflictSpreads * null.conflict_spread, kConflictSlack);
}

// Without free space only the distances can tell that registration left for the wrong place (step F11).
double theta_limit(const MapNull& null) {
  return null.log10_theta - std::max(kThetaSpreads * null.log10_theta_spread, kThetaSlack);
}

// A move beyond the tolerance may then be that of other surfaces.
bool surfaces_may_differ(const PairEvidence& pair, const MapNull& null) {
  return may_show_different_places(pair, null) || free_space_is_silent(pair, null);
}

void note_support(const RegistrationResult& registration, const Agreement& agreement, PairVerdict& verdict) {
  verdict.evidence["support"] = {static_cast<double>(registration.support_start),
                                 static_cast<double>(registration.support_end), std::nullopt};
  verdict.evidence["bend_m"].value = registration.bend.rms_m;
  if (registration.searched) {
    verdict.evidence["agreeing"] = {static_cast<double>(agreement.agreeing),
                                    static_cast<double>(agreement.contradicting), std::nullopt};
  }
  if (registration.ambiguity) verdict.evidence["ambiguity"].value = *registration.ambiguity;
}

// A ratio, where with this probability what was found is as likely either way.
double bounded(double log_ratio, double unless) {
  const double strength = std::log(unless + (1.0 - unless) * std::exp(-std::abs(log_ratio)));
  return log_ratio > 0.0 ? -strength : strength;
}

// With some probability the registration is wrong, and what it found is as likely either way. `vouched`: others around
// it, which nothing misleads, found the same.
void disbelieve(const PairEvidence& pair, const MapNull& null, bool vouched, const JudgeOptions& options,
                PairVerdict& verdict) {
  verdict.p_value.reset();
  std::optional<double>& log_ratio = verdict.evidence.at("disagreement").log_ratio;
  const bool above = *log_ratio > 0.0;
  const bool telling = above && !conflict_grew(pair) && !surfaces_may_differ(pair, null);
  const double wrong = above && vouched ? kDeniedByNeighbours : telling ? kLeavesRightPlace : kWrongWhenDoubted;
  log_ratio = bounded(*log_ratio, wrong);
  set_posterior(*log_ratio, options, verdict);
}

constexpr double kLeastShare = 0.05;  // of its mean keeps a law one where noise or cells explain all of it

// What cells hide makes a measured offset larger than the true one, by as much in its square as it may be larger yet:
// what they alone would show says nothing against the map.
OffsetEstimate::SquareLaw less_cells(const OffsetEstimate::SquareLaw& law, const OffsetEstimate& offset) {
  if (offset.cells_sigma_m == 0.0) return law;
  const double cells_m2 = offset.cells_sigma_m * offset.cells_sigma_m;
  return {std::max(law.mean_m2 - 2.0 * cells_m2, kLeastShare * law.mean_m2), law.variance_m4};
}

// Noise makes a measured offset larger than the true one, by as much in its square as the law adds to it once more: the
// law of what is known to be there at least.
OffsetEstimate::SquareLaw less_noise(const OffsetEstimate& offset) {
  const OffsetEstimate::SquareLaw& law = offset.measured;
  return {std::max(law.mean_m2 - 2.0 * offset.bias_m2(), kLeastShare * law.mean_m2), law.variance_m4};
}

// Of two ratios the one that says less; nothing where they contradict each other.
double weaker(double a, double b) {
  if ((a > 0.0) != (b > 0.0)) return 0.0;
  return std::abs(a) < std::abs(b) ? a : b;
}

// What is reported whatever the verdict.
void note_offset(const OffsetEstimate& offset, const Bend& bend, PairVerdict& verdict) {
  verdict.offset_m = offset.offset_m;
  verdict.offset_rad = offset.offset_rad;
  verdict.offset_vector_m = offset.vector_m;
  verdict.offset_least_m = std::min(offset_quantile_m(less_noise(offset), 0.975), offset.offset_m);
  const Bend none{.kind = bend.kind};
  const OffsetEstimate::SquareLaw least = disagreement_law(less_noise(offset), none);
  const OffsetEstimate::SquareLaw most = disagreement_law(offset.measured, none);
  verdict.offset_interval_m = {std::min(offset_quantile_m(least, 0.975), offset.offset_m),
                               std::max(offset_quantile_m(most, 0.025), offset.offset_m)};
  verdict.minimum_detectable_m = offset.minimum_detectable_m;
}

void note_disagreement(const PairEvidence& pair, const OffsetEstimate& offset, const JudgeOptions& options,
                       PairVerdict& verdict) {
  const Bend& bend = pair.registration->bend;
  const auto log_ratio_of = [&](const OffsetEstimate::SquareLaw& measured,
                                const OffsetEstimate::SquareLaw& with_prior) {
    const auto ratio_of = [&](const OffsetEstimate::SquareLaw& seen, const OffsetEstimate::SquareLaw& all) {
      const LogTails tails = log_tails_with_hidden(seen, all, options.tolerance_m);
      return std::clamp(tails.above - tails.below, -kMaxLogOdds, kMaxLogOdds);
    };
    return weaker(ratio_of(measured, with_prior),
                  ratio_of(less_cells(measured, offset), less_cells(with_prior, offset)));
  };
  const OffsetEstimate::SquareLaw measured = disagreement_law(offset.measured, bend);
  const OffsetEstimate::SquareLaw with_prior = disagreement_law(offset.with_prior, bend);
  verdict.evidence["displacement"] = {offset.offset_m, options.tolerance_m,
                                      log_ratio_of(offset.measured, offset.with_prior)};
  const double apart_m = std::hypot(offset.offset_m, bend.rms_m);
  double log_ratio = log_ratio_of(measured, with_prior);
  if (log_ratio < 0.0 && free_space_is_unknown(pair)) log_ratio = bounded(log_ratio, kBentUnseen);
  verdict.evidence["disagreement"] = {apart_m, options.tolerance_m, log_ratio};
  verdict.disagreement_m = apart_m;
  verdict.disagreement_most_m =
      std::max({offset_quantile_m(measured, kConsistentTail), offset_quantile_m(with_prior, kConsistentTail), apart_m});
  set_posterior(log_ratio, options, verdict);
  // Standard deviation of the root of a sum of squares.
  const double along_m4 = std::pow(offset.offset_m * offset.sigma_m, 2) + 0.25 * bend.variance_m4 +
                          std::pow(places_scatter(bend) * apart_m * apart_m, 2);
  const double sigma_m = apart_m > 0.0 ? std::sqrt(along_m4) / apart_m : offset.sigma_m;
  const double beyond_noise_m = std::sqrt(std::max(apart_m * apart_m - offset.bias_m2(), 0.0));
  verdict.p_value = std::exp(log_normal_tail((beyond_noise_m - options.tolerance_m) / sigma_m));
}

std::string_view bent_one(const Bend& bend) {
  switch (bend.kind) {
    case BendKind::kSource:
      return "the source";
    case BendKind::kTarget:
      return "the target";
    case BendKind::kSpace:
      return "one of the two";
  }
  return "";
}

std::string in_cm(double metres) { return fmt::format("{:.1f} cm", 100.0 * metres); }

// What cells leave open, for the end of a reason; empty where points are means of hits.
std::string left_open_by_cells(const PairEvidence& pair, const OffsetEstimate& offset) {
  if (pair.grain.cell_m == 0.0) return {};
  return fmt::format("its points are the centres of cells of {:.4g} m, which leave {} open (one sigma)",
                     pair.grain.cell_m, in_cm(offset.cells_sigma_m));
}

// Whether most of what is not known of the offset is what cells hide.
bool cells_hide_most(const OffsetEstimate& offset) {
  const double uncertain_m2 = offset.measured.mean_m2 - offset.offset_m * offset.offset_m;
  return offset.cells_sigma_m * offset.cells_sigma_m > 0.5 * uncertain_m2;
}

// Why the registered pose cannot be believed; empty if it can. Where the pose barely moved and a submap is bent,
// conflict is what a bend looks like and no reason for doubt.
std::string doubt(const PairEvidence& pair, const MapNull& null, bool moved, bool conflict_counts) {
  const PoseEvidence& after = *pair.registered;
  if (std::string against = doubt_of_rivals(pair); !against.empty()) return against;
  if (after.overlap < kOverlapKept * pair.map.overlap) {
    return fmt::format("registration lost overlap ({:.0f} % to {:.0f} %): the places may differ",
                       100.0 * pair.map.overlap, 100.0 * after.overlap);
  }
  if (conflict_counts && after.conflict.known() > 0 && after.conflict.share() > conflict_limit(null)) {
    return fmt::format(
        "after registration {:.0f} % of what both saw still conflicts (typical of this map: {:.0f} %): the places "
        "differ, or registration settled in the wrong place",
        100.0 * after.conflict.share(), 100.0 * null.conflict);
  }
  if (moved && free_space_is_unknown(pair) && after.score && after.score->log10_gamma &&
      *after.score->log10_gamma < theta_limit(null)) {
    return fmt::format(
        "after registration it agrees worse than other pairs of this map (log10 Theta {:.2f}, typically {:.2f}), and "
        "points alone cannot say why",
        *after.score->log10_gamma, null.log10_theta);
  }
  return {};
}

void forget_gap(PairVerdict& verdict) {
  verdict.gap_m.reset();
  verdict.evidence.erase("gap_m");
}

// Whether those around it ask for the move beyond the tolerance that its registration found, and do not contradict it.
bool move_is_vouched_for(const PairEvidence& pair, const JudgeOptions& options) {
  return pair.registered && is_vouched_for(pair) && !contradicted(pair) &&
         estimate_offset(*pair.registration, pair.T_target_source).offset_m > options.tolerance_m;
}

// Why there is no displacement to judge; empty if there is one.
std::string nothing_to_compare(const PairEvidence& pair, const MapNull& null, const JudgeOptions& options) {
  if (!pair.overlaps && !pair.registered) return pair.gate.empty() ? "too little overlap" : pair.gate;
  if (shows_no_common_side(pair, null) && !move_is_vouched_for(pair, options)) {
    return fmt::format(
        "too little overlap: of {} voxels that match, {} show a side that both saw, and no free space speaks against "
        "the map: the places may differ",
        pair.map.matched, pair.common->matched);
  }
  return registration_failure(pair);
}

PairVerdict judge_displacement(const PairEvidence& pair, const MapNull& null, const JudgeOptions& options) {
  PairVerdict verdict;
  note_measurements(pair, null, verdict);
  verdict.reason = nothing_to_compare(pair, null, options);
  if (!pair.registered) {
    let_movers_speak(pair, options, verdict);
    return verdict;
  }
  verdict.unobservable = pair.registration->unobservable;
  const OffsetEstimate offset = estimate_offset(*pair.registration, pair.T_target_source);
  note_offset(offset, pair.registration->bend, verdict);
  // Walls that are farther apart than gaps are looked for leave only the floor's, which is not theirs.
  if (offset.vector_m.norm() > ParallelGap::kMost_m) forget_gap(verdict);
  if (!verdict.reason.empty()) return verdict;
  const Bend& bend = pair.registration->bend;
  note_disagreement(pair, offset, options, verdict);
  note_support(*pair.registration, pair.agreement, verdict);
  const std::string measured =
      fmt::format("offset {} ({} to {})", in_cm(offset.offset_m), in_cm((*verdict.offset_interval_m)[0]),
                  in_cm((*verdict.offset_interval_m)[1]));
  verdict.rigid = is_rigid(*pair.registration, options);
  verdict.bent = bent_one(bend);
  const bool moved = offset.offset_m > options.tolerance_m;
  const bool beyond = *verdict.disagreement_m > options.tolerance_m;
  const auto call_doubtful = [&](std::string reason) {
    verdict.reason = std::move(reason);
    const double p_value = *verdict.p_value;
    const bool vouched = move_is_vouched_for(pair, options);
    disbelieve(pair, null, vouched, options, verdict);
    if (vouched) let_neighbours_speak(pair, p_value, verdict);
    if (moved && contradicted(pair)) let_better_fit_speak(pair, p_value, verdict);
  };
  if (const std::string why_not = doubt(pair, null, moved, verdict.rigid || moved); !why_not.empty()) {
    call_doubtful(fmt::format("{}; {}", measured, why_not));
  } else if (moved && !fit_improved(pair)) {
    call_doubtful(
        conflict_grew(pair)
            ? fmt::format("{}, but what both saw conflicts more there: a similar place may be what fits", measured)
            : fmt::format("{}, but the pair agrees no better there", measured));
  } else if (beyond && surfaces_may_differ(pair, null)) {
    call_doubtful(fmt::format(
        "{}, but few voxels show a side that both saw, and no free space speaks against the map: the places may differ",
        measured));
  } else if (beyond) {
    const std::string bent =
        bend_tells(verdict) ? fmt::format(", {} apart with what no rigid motion mends", in_cm(*verdict.disagreement_m))
                            : std::string();
    verdict.reason = fmt::format("{}{}: not told from the tolerance of {} over the whole map", measured, bent,
                                 in_cm(options.tolerance_m));
    if (const std::string cells = left_open_by_cells(pair, offset); !cells.empty()) verdict.reason += "; " + cells;
  } else if (log_tails_with_hidden(disagreement_law(offset.measured, bend), disagreement_law(offset.with_prior, bend),
                                   options.tolerance_m)
                 .above <= std::log(kConsistentTail)) {
    verdict.reason = fmt::format("{}: below the tolerance of {}", measured, in_cm(options.tolerance_m));
    if (*verdict.p_inconsistent <= kConsistentTail) {
      verdict.verdict = Verdict::kConsistent;
    } else {
      verdict.reason += fmt::format(
          ", but with {:.2g} of all pairs believed inconsistent before looking it is not "
          "told from that: {:.2g} is left",
          options.prior_inconsistent, *verdict.p_inconsistent);
    }
  } else if (log_tails(disagreement_law(offset.measured, bend), options.tolerance_m).above <=
             std::log(kConsistentTail)) {
    verdict.reason = fmt::format("{}, but a direction that nothing in the scene fixes could hide {}", measured,
                                 in_cm(2.0 * offset.hidden_sigma_m));
  } else if (cells_hide_most(offset)) {
    verdict.reason = fmt::format("{}: {}, too much for the tolerance of {}", measured, left_open_by_cells(pair, offset),
                                 in_cm(options.tolerance_m));
  } else {
    verdict.reason =
        fmt::format("{}: too uncertain to be told from the tolerance of {}", measured, in_cm(options.tolerance_m));
  }
  return verdict;
}

}  // namespace

std::vector<OptionField> fields(JudgeOptions& o) {
  return {
      choice_option(
          "judge", o.method, {"displacement", "gamma"},
          "What verdicts rest on: registration's displacement against the tolerance, or the paper's Gamma and "
          "Theta alone."),
      real_option("tolerance", o.tolerance_m, Unit::kMetre, 0.001, 100.0,
                  "Disagreement (RMS displacement over what both submaps saw) that can be lived with."),
      real_option("alpha", o.alpha, Unit::kRatio, 1e-9, 0.5,
                  "False-discovery level of `inconsistent` verdicts over the map."),
      real_option("prior_inconsistent", o.prior_inconsistent, Unit::kRatio, 1e-6, 1.0 - 1e-6,
                  "Share of pairs believed inconsistent before looking."),
      real_option("min_decided", o.min_decided, Unit::kRatio, 0.0, 1.0,
                  "Share of overlapping pairs, of each kind and each two robots, that must be decided for a consistent "
                  "map."),
  };
}

Standing standing_of(const PairVerdict& verdict, const JudgeOptions& options) {
  if (verdict.verdict == Verdict::kConsistent) return Standing::kStays;
  const bool believed = verdict.p_value && *verdict.p_value <= kSurely && !verdict.without_registration;
  return believed && *verdict.offset_least_m > options.tolerance_m ? Standing::kMoves : Standing::kDoubted;
}

bool is_rigid(const RegistrationResult& registration, const JudgeOptions& options) {
  return registration.bend.rms_m <= options.tolerance_m;
}

bool may_show_different_places(const PairEvidence& pair, const MapNull& null) {
  return pair.common && !pair.common->enough && pair.map.conflict.share() <= conflict_limit(null);
}

bool shows_no_common_side(const PairEvidence& pair, const MapNull& null) {
  return may_show_different_places(pair, null) && !pair.common->any;
}

PairVerdict judge_pair(const PairEvidence& pair, const MapNull& null, const JudgeOptions& options) {
  PairVerdict verdict = judge_displacement(pair, null, options);
  if (verdict.verdict != Verdict::kConsistent) let_free_space_speak(pair, null, options, verdict);
  if (verdict.verdict == Verdict::kUnverified && may_show_different_places(pair, null) && pair.common->any) {
    verdict.reason += fmt::format("; only {:.0f} % show a side that both saw: the map's verdict does not wait for it",
                                  100.0 * pair.common->overlap);
  }
  return verdict;
}

}  // namespace kilter
