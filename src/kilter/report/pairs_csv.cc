// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/report/pairs_csv.h"

#include <fmt/format.h>

#include <array>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kilter/report/csv_cell.h"

namespace kilter {
namespace {

constexpr std::string_view kColumns =
    "target,source,kind,overlap,matched,d,mu,sigma,mu_t,var_t,gamma,gamma_literal,theta,theta_oicp,verified,"
    "offset_m,offset_low_m,offset_high_m,offset_deg,offset_x,offset_y,offset_z,gap_m,minimum_detectable_m,unobservable,"
    "p_value,log_odds,p_inconsistent,verdict,reason,constraint";

// What a pair may have measured (docs/verdicts.md): columns are the same for every map, cells may be empty.
constexpr std::array<std::string_view, 12> kEvidence = {
    "agreeing",     "ambiguity", "bend_m",      "conflict",        "conflict_registered", "disagreement",
    "displacement", "gap_m",     "log10_gamma", "mean_distance_m", "same_side",           "support"};

using Cells = std::vector<std::optional<double>>;

// The columns from overlap to verified.
Cells measured(const PairResult& pair) {
  Cells cells = {pair.overlap, static_cast<double>(pair.matched), pair.max_distance_m};
  if (pair.score && pair.score->fit.parent) {
    cells.insert(cells.end(), {pair.score->fit.parent->mu_m, pair.score->fit.parent->sigma_m});
  } else {
    cells.resize(cells.size() + 2);
  }
  if (pair.score) {
    cells.insert(cells.end(), {pair.score->fit.mu_t_m, pair.score->fit.var_t_m2, pair.score->gamma_per_m3,
                               pair.score->gamma_literal_per_m3});
  } else {
    cells.resize(cells.size() + 4);
  }
  cells.push_back(pair.registered_score ? pair.registered_score->gamma_per_m3 : std::nullopt);
  cells.insert(cells.end(), {pair.theta_oicp_per_m3, pair.verified});
  return cells;
}

// The columns from offset_m to p_inconsistent.
Cells judged(const PairResult& pair) {
  const PairVerdict& verdict = pair.verdict;
  Cells cells = {verdict.offset_m};
  if (verdict.offset_interval_m) {
    cells.insert(cells.end(), {(*verdict.offset_interval_m)[0], (*verdict.offset_interval_m)[1]});
  } else {
    cells.resize(cells.size() + 2);
  }
  cells.push_back(verdict.offset_rad ? std::optional(*verdict.offset_rad * 180.0 / std::numbers::pi) : std::nullopt);
  for (int axis = 0; axis < 3; ++axis) {
    cells.push_back(verdict.offset_vector_m ? std::optional((*verdict.offset_vector_m)[axis]) : std::nullopt);
  }
  cells.insert(cells.end(), {verdict.gap_m, verdict.minimum_detectable_m});
  const bool looked = pair.T_target_source_registered || !verdict.unobservable.empty();
  cells.push_back(looked ? std::optional(static_cast<double>(verdict.unobservable.size())) : std::nullopt);
  cells.insert(cells.end(), {verdict.p_value, verdict.log_odds, verdict.p_inconsistent});
  return cells;
}

// The columns from offset_rx to offset_rz: the turn as a vector along the target's axes. [rad]
Cells turned(const PairResult& pair) {
  const std::optional<Eigen::Vector3d> turn_rad = offset_rotation_rad(pair);
  if (!turn_rad) return Cells(3);
  return {turn_rad->x(), turn_rad->y(), turn_rad->z()};
}

void append(std::string& text, const Cells& cells) {
  for (const std::optional<double>& cell : cells) text += ',' + csv_cell(cell);
}

}  // namespace

std::string pairs_csv(const Result& result) {
  std::string text(kColumns);
  for (const std::string_view name : kEvidence) text += fmt::format(",evidence_{0},evidence_{0}_log_ratio", name);
  text += ",offset_rx,offset_ry,offset_rz\n";
  for (const PairResult& pair : result.pairs) {
    text += csv_cell(result.submap(pair.id.target).name) + ',' + csv_cell(result.submap(pair.id.source).name);
    text += ',' + csv_cell(to_string(pair.kind));
    append(text, measured(pair));
    append(text, judged(pair));
    text += ',' + csv_cell(to_string(pair.verdict.verdict)) + ',' + csv_cell(pair.verdict.reason);
    text += pair.trusted ? ",1" : ",0";
    for (const std::string_view name : kEvidence) {
      const auto piece = pair.verdict.evidence.find(std::string(name));
      const bool there = piece != pair.verdict.evidence.end();
      append(text, {there ? piece->second.value : std::nullopt, there ? piece->second.log_ratio : std::nullopt});
    }
    append(text, turned(pair));
    text += '\n';
  }
  return text;
}

}  // namespace kilter
