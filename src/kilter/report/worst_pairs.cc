// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/report/worst_pairs.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>
#include <tuple>

#include <fmt/format.h>

#include "kilter/base/contract.h"
#include "kilter/base/expected.h"
#include "kilter/report/text_lines.h"
#include "kilter/report/upright_turn.h"

namespace kilter {
namespace {

constexpr std::array kKinds = {PairKind::kSequential, PairKind::kLocal, PairKind::kGlobal};

std::string probability_text(std::optional<double> p) {
  if (!p) return "-";
  if (*p > 0.995) return ">0.99";
  if (*p < 0.005) return "<0.01";
  return fmt::format("{:.2f}", *p);
}

std::string offset_text(const PairVerdict& verdict) {
  if (!verdict.offset_m) return "-";
  const int decimals = *verdict.offset_m < 0.1 ? 1 : 0;
  std::string text = fmt::format("{:.{}f} cm", *verdict.offset_m * 100.0, decimals);
  if (verdict.offset_interval_m) {
    const auto [low_m, high_m] = *verdict.offset_interval_m;
    text += fmt::format(" [{:.{}f}, {:.{}f}]", low_m * 100.0, decimals, high_m * 100.0, decimals);
  }
  return text;
}

// Whether the registration behind a pair's offset is believed: a displacement that is not has no p-value, and where the
// map's pose is wrong without it, which one is right is open.
bool is_believed(const PairVerdict& verdict) { return verdict.p_value && !verdict.without_registration; }

// The paper's own test has no p-values and takes registration as it is.
bool is_known(const PairVerdict& verdict, bool papers_test) { return papers_test || is_believed(verdict); }

bool is_inconsistent(const PairResult& pair) { return pair.verdict.verdict == Verdict::kInconsistent; }

std::string turn_text(const Result& result, const PairResult& pair, bool papers_test) {
  if (!pair.verdict.offset_rad) return "-";
  const double degrees = *pair.verdict.offset_rad * 180.0 / std::numbers::pi;
  const std::string text = fmt::format("{:.1f} deg", degrees);
  const std::optional<Eigen::Vector3d> turn_rad = offset_rotation_rad(pair);
  if (!turn_rad || degrees < 0.05 || !is_known(pair.verdict, papers_test)) return text;
  const Eigen::Vector3d turn_world_rad = result.submap(pair.id.target).T_world_submap.rotation() * *turn_rad;
  if (!is_mostly_upright(turn_world_rad)) return text;
  return (turn_world_rad.z() > 0.0 ? '+' : '-') + text;
}

std::string shift_text(const Result& result, const PairResult& pair, bool papers_test) {
  if (!pair.verdict.offset_vector_m) return "-";
  if (!is_known(pair.verdict, papers_test)) return "not known";
  const Pose3& T_world_target = result.submap(pair.id.target).T_world_submap;
  const Eigen::Vector3d shift_cm = T_world_target.rotation() * *pair.verdict.offset_vector_m * 100.0;
  const int decimals = shift_cm.norm() < 10.0 ? 1 : 0;
  const double step = decimals == 1 ? 0.1 : 1.0;
  // Rounded before it is printed, or -0.2 would read "-0".
  const Eigen::Vector3d shown = (shift_cm / step).array().round() * step + 0.0;
  return fmt::format("x{:+.{}f} y{:+.{}f} z{:+.{}f}{}", shown.x(), decimals, shown.y(), decimals, shown.z(), decimals,
                     pair.verdict.unobservable.empty() ? "" : " +?");
}

using Row = std::array<std::string, 6>;

Row worst_row(const Result& result, const PairResult& pair, bool papers_test) {
  const char mark = is_inconsistent(pair) ? '!' : pair.verdict.verdict == Verdict::kUnverified ? '?' : ' ';
  return {fmt::format("{} {} <- {}", mark, cut_front(printable(result.submap(pair.id.target).name), 13),
                      cut_front(printable(result.submap(pair.id.source).name), 13)),
          std::string(to_string(pair.kind)),
          offset_text(pair.verdict),
          turn_text(result, pair, papers_test),
          shift_text(result, pair, papers_test),
          "p " + probability_text(pair.verdict.p_inconsistent)};
}

}  // namespace

std::vector<const PairResult*> worst_pairs(const Result& result, std::size_t count) {
  KILTER_EXPECTS(count >= kKinds.size());
  std::vector<const PairResult*> pairs;
  for (const PairResult& pair : result.pairs) {
    if (is_inconsistent(pair) || pair.verdict.offset_m) pairs.push_back(&pair);
  }
  const auto badness = [](const PairResult& pair) {
    const bool in_a_row = is_inconsistent(pair) && pair.kind == PairKind::kSequential;
    return std::tuple(in_a_row, is_inconsistent(pair), is_believed(pair.verdict), pair.verdict.offset_m.value_or(0.0));
  };
  std::stable_sort(pairs.begin(), pairs.end(),
                   [&](const PairResult* a, const PairResult* b) { return badness(*a) > badness(*b); });
  // The first inconsistent pair of each kind; the places that are left go to the worst others.
  std::vector<const PairResult*> shown;
  for (const PairKind kind : kKinds) {
    const auto first = std::find_if(pairs.begin(), pairs.end(), [&](const PairResult* pair) {
      return is_inconsistent(*pair) && pair->kind == kind;
    });
    if (first != pairs.end()) shown.push_back(*first);
  }
  for (const PairResult* pair : pairs) {
    if (shown.size() >= count) break;
    if (std::find(shown.begin(), shown.end(), pair) == shown.end()) shown.push_back(pair);
  }
  std::stable_sort(shown.begin(), shown.end(),
                   [&](const PairResult* a, const PairResult* b) { return badness(*a) > badness(*b); });
  return shown;
}

std::vector<std::string> worst_pair_lines(const Result& result, bool papers_test, std::size_t columns) {
  std::vector<Row> rows;
  for (const PairResult* pair : worst_pairs(result, 5)) rows.push_back(worst_row(result, *pair, papers_test));
  if (rows.empty()) return {};
  std::vector<std::string> lines = {
      fmt::format("{}, target <- source (! inconsistent, ? unverified): offset [95 %], turn (+ left) and",
                  result.system.state == MapState::kInconsistent ? "Worst pairs" : "Largest offsets"),
      "shift of the source [cm, world axes, +? open] that mend the middle of what both saw, p inconsistent"};
  std::array<std::size_t, std::tuple_size_v<Row>> widths{};
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], columns_of(row[i]));
  }
  for (const Row& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) line += (i > 0 ? "  " : "") + padded(row[i], widths[i]);
    lines.push_back(cut_end(line.substr(0, line.find_last_not_of(' ') + 1), columns));
  }
  return lines;
}

}  // namespace kilter
