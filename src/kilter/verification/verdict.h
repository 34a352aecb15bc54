// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kilter/geometry/pose3.h"
#include "kilter/submap/ids.h"

namespace kilter {

enum class Verdict {
  kConsistent,    ///< disagreement below the tolerance is established, in every direction
  kInconsistent,  ///< disagreement above the tolerance is established
  kUnverified,    ///< neither; the reason says why
};

enum class MapState { kConsistent, kInconsistent, kUndetermined };

[[nodiscard]] constexpr std::string_view to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::kConsistent:
      return "consistent";
    case Verdict::kInconsistent:
      return "inconsistent";
    case Verdict::kUnverified:
      return "unverified";
  }
  return "";
}

[[nodiscard]] constexpr std::string_view to_string(MapState state) {
  switch (state) {
    case MapState::kConsistent:
      return "consistent";
    case MapState::kInconsistent:
      return "inconsistent";
    case MapState::kUndetermined:
      return "undetermined";
  }
  return "";
}

/// One piece of evidence: what was measured, what a good pair of this map shows, and how strongly it speaks
/// (natural log of the likelihood ratio inconsistent : consistent). Absent where not computed.
struct Evidence {
  std::optional<double> value;
  std::optional<double> null;
  std::optional<double> log_ratio;
};

/// The answer for one pair, with what it rests on.
struct PairVerdict {
  Verdict verdict = Verdict::kUnverified;
  std::string reason;  ///< one sentence, also for decided pairs
  std::map<std::string, Evidence> evidence;
  std::optional<double> offset_m;  ///< RMS displacement over the overlap, registered against map. [m]
  /// RMS over the overlap of everything that lies apart: the offset, and what no rigid motion mends. [m]
  std::optional<double> disagreement_m;
  std::optional<double> disagreement_most_m;  ///< that with 95 %, what is hidden at the prior's width. [m]
  /// 95 %, over the observable directions and over all places that both saw (places_scatter). [m]
  std::optional<std::array<double, 2>> offset_interval_m;
  std::optional<double> offset_least_m;            ///< the same at its low end, over the places that maps show. [m]
  std::optional<double> offset_rad;                ///< rotation part
  std::optional<Eigen::Vector3d> offset_vector_m;  ///< registered minus map at the overlap's centre, target axes
  std::optional<double> gap_m;                     ///< double-wall gap
  std::optional<double> minimum_detectable_m;      ///< smallest offset that this pair would reveal. [m]
  std::vector<Vector6> unobservable;               ///< unit twists about the overlap's centre, target axes
  std::optional<double> p_value;                   ///< for "at most the tolerance"
  bool rigid = true;  ///< false if parts stay apart by over the tolerance whatever the rigid motion: a submap is bent
  /// What the verdict rests on where the registration is not believed, and so not handed on.
  std::optional<std::string> without_registration;
  std::string bent;  ///< which: "the source", "the target", "one of the two"; meaningful where `rigid` is false
  std::optional<double> log_odds;  ///< ln(p / (1 - p)) of p_inconsistent
  std::optional<double> p_inconsistent;
};

/// Whether a reader has to be told of the bend: with it clearly more lies apart than the offset alone. Precondition:
/// both are there.
[[nodiscard]] inline bool bend_tells(const PairVerdict& verdict) {
  return *verdict.disagreement_m > 1.05 * *verdict.offset_m;
}

/// Eq. (6)-(7) as sums of log(1 - p_inconsistent); absent where no pair of that level has a probability.
struct LogProbability {
  std::optional<double> total;
  std::optional<double> per_pair;            ///< total / number of pairs
  std::map<std::string, double> sequential;  ///< by robot
  std::map<std::string, double> local;       ///< by robot
  std::map<std::string, double> global;      ///< by "a,b"
};

/// Share of the overlapping pairs that were decided; absent for kinds that do not occur.
struct DecidedShares {
  std::optional<double> sequential;
  std::optional<double> local;
  std::map<std::string, std::optional<double>> global;  ///< by "a,b", every two robots; absent where they never meet
};

/// The answer for the whole map.
struct MapVerdict {
  MapState state = MapState::kUndetermined;
  std::string reason;                        ///< one sentence
  std::optional<double> certificate_m;       ///< smallest X of "consistent to X m at 95 %"
  std::optional<PairId> certificate_of;      ///< the pair whose disagreement may be as large
  std::vector<PairId> certificate_excludes;  ///< overlapping pairs that the certificate says nothing about
  /// Submaps outside the largest part that pairs with a bounded disagreement tie together; above 0 there is no
  /// certificate.
  std::size_t untied = 0;
  LogProbability log_probability;
  std::size_t tested = 0;
  std::size_t inconsistent = 0;
  std::size_t unverified = 0;
  DecidedShares decided;
};

}  // namespace kilter
