// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "kilter/verification/judge.h"

namespace kilter {
namespace {

// Benjamini-Hochberg: the largest p that is still a discovery at level alpha, or a negative number.
double discovery_threshold(std::vector<double> p_values, double alpha) {
  std::sort(p_values.begin(), p_values.end());
  for (std::size_t k = p_values.size(); k > 0; --k) {
    if (p_values[k - 1] <= alpha * static_cast<double>(k) / static_cast<double>(p_values.size()))
      return p_values[k - 1];
  }
  return -1.0;
}

std::string why_inconsistent(const PairVerdict& verdict, const JudgeOptions& options) {
  if (verdict.without_registration) return *verdict.without_registration;
  const auto& interval = *verdict.offset_interval_m;
  const std::string offset = fmt::format("offset {:.1f} cm ({:.1f} to {:.1f} cm)", 100.0 * *verdict.offset_m,
                                         100.0 * interval[0], 100.0 * interval[1]);
  const std::string above = fmt::format("above the tolerance of {:.1f} cm", 100.0 * options.tolerance_m);
  if (*verdict.offset_m <= options.tolerance_m) {
    return fmt::format(
        "{}, but with it parts of the overlap lie {:.1f} cm apart (RMS), {}: {} is bent, or slipped inside", offset,
        100.0 * *verdict.disagreement_m, above, verdict.bent);
  }
  // Where offset and bend are above only together, the reader has to be told of both.
  if (interval[0] <= options.tolerance_m && bend_tells(verdict)) {
    return fmt::format("{}, and with what no rigid motion mends {:.1f} cm apart: {}", offset,
                       100.0 * *verdict.disagreement_m, above);
  }
  if (verdict.rigid) return fmt::format("{}: {}", offset, above);
  return fmt::format("{}: {}; no rigid motion mends all of it, {} is bent, or slipped inside", offset, above,
                     verdict.bent);
}

void decide_inconsistent(std::vector<JudgedPair>& pairs, const JudgeOptions& options) {
  std::vector<double> p_values;
  for (const JudgedPair& pair : pairs) {
    if (pair.verdict.p_value) p_values.push_back(*pair.verdict.p_value);
  }
  const double threshold = discovery_threshold(p_values, options.alpha);
  for (JudgedPair& pair : pairs) {
    if (!pair.verdict.p_value || *pair.verdict.p_value > threshold) continue;
    if (*pair.verdict.log_odds <= 0.0) continue;  // nothing is established that is likelier not so
    pair.verdict.verdict = Verdict::kInconsistent;
    pair.verdict.reason = why_inconsistent(pair.verdict, options);
  }
}

std::string robots_key(const JudgedPair& pair, std::span<const std::string> robots) {
  const int first = std::min(pair.source_robot, pair.target_robot);
  const int second = std::max(pair.source_robot, pair.target_robot);
  return robots[static_cast<std::size_t>(first)] + "," + robots[static_cast<std::size_t>(second)];
}

// Every two robots as people read them, by key: a key cannot be taken apart, for names may hold commas.
std::map<std::string, std::string> meetings_in_words(std::span<const std::string> robots) {
  std::map<std::string, std::string> words;
  for (std::size_t a = 0; a < robots.size(); ++a) {
    for (std::size_t b = a + 1; b < robots.size(); ++b) {
      words.try_emplace(robots[a] + "," + robots[b],
                        fmt::format("{} and {}", printable(robots[a]), printable(robots[b])));
    }
  }
  return words;
}

// Eq. (6)-(7).
LogProbability sum_log_probability(const std::vector<JudgedPair>& pairs, std::span<const std::string> robots) {
  LogProbability sums;
  double total = 0.0;
  std::size_t count = 0;
  for (const JudgedPair& pair : pairs) {
    if (!pair.verdict.log_odds) continue;
    // log(1 - p) = -log(1 + exp(log odds)), without losing it where p is close to 1.
    const double odds = *pair.verdict.log_odds;
    const double term = odds > 0.0 ? -odds - std::log1p(std::exp(-odds)) : -std::log1p(std::exp(odds));
    total += term;
    ++count;
    switch (pair.kind) {
      case PairKind::kSequential:
        sums.sequential[robots[static_cast<std::size_t>(pair.source_robot)]] += term;
        break;
      case PairKind::kLocal:
        sums.local[robots[static_cast<std::size_t>(pair.source_robot)]] += term;
        break;
      case PairKind::kGlobal:
        sums.global[robots_key(pair, robots)] += term;
        break;
    }
  }
  if (count > 0) {
    sums.total = total;
    sums.per_pair = total / static_cast<double>(count);
  }
  return sums;
}

// What should be decided, and what was.
bool counts(const JudgedPair& pair) {
  return (pair.overlaps && pair.waited_for) || pair.verdict.verdict != Verdict::kUnverified;
}

struct Share {
  std::size_t decided = 0;
  std::size_t overlapping = 0;
  void add(const JudgedPair& pair) {
    overlapping += 1;
    decided += pair.verdict.verdict == Verdict::kUnverified ? 0 : 1;
  }
  [[nodiscard]] std::optional<double> value() const {
    if (overlapping == 0) return std::nullopt;
    return static_cast<double>(decided) / static_cast<double>(overlapping);
  }
};

DecidedShares decided_shares(const std::vector<JudgedPair>& pairs, std::span<const std::string> robots) {
  Share sequential;
  Share local;
  std::map<std::string, Share> global;
  for (std::size_t a = 0; a < robots.size(); ++a) {
    for (std::size_t b = a + 1; b < robots.size(); ++b) global[robots[a] + "," + robots[b]];
  }
  for (const JudgedPair& pair : pairs) {
    if (!counts(pair)) continue;
    if (pair.kind == PairKind::kSequential) sequential.add(pair);
    if (pair.kind == PairKind::kLocal) local.add(pair);
    if (pair.kind == PairKind::kGlobal) global[robots_key(pair, robots)].add(pair);
  }
  DecidedShares shares;
  shares.sequential = sequential.value();
  shares.local = local.value();
  for (const auto& [key, share] : global) shares.global[key] = share.value();
  return shares;
}

// Why too little was decided; empty if enough was.
std::string undecided(const DecidedShares& shares, const std::vector<JudgedPair>& pairs,
                      std::span<const std::string> robots, const JudgeOptions& options) {
  if (pairs.empty()) return "nothing to compare: no two submaps could show the same place";
  if (std::none_of(pairs.begin(), pairs.end(), counts))
    return "nothing to compare: no two submaps show enough of the same place";
  const std::map<std::string, std::string> in_words = meetings_in_words(robots);
  const auto too_few = [&](double share) { return share <= 0.0 || share < options.min_decided; };
  for (const auto& of_robots : shares.global) {
    const std::string& key = of_robots.first;  // clang 14 lets no lambda capture a structured binding
    const std::optional<double> share = of_robots.second;
    if (share && !too_few(*share)) continue;
    const bool listed = std::any_of(pairs.begin(), pairs.end(), [&](const JudgedPair& pair) {
      return pair.kind == PairKind::kGlobal && robots_key(pair, robots) == key;
    });
    const std::string& names = in_words.at(key);
    if (!listed) return fmt::format("robots {} never meet", names);
    if (!share) return fmt::format("robots {} never show enough of the same place", names);
    return fmt::format("only {:.0f} % of what robots {} both saw could be decided", 100.0 * *share, names);
  }
  const bool has_sequential =
      std::any_of(pairs.begin(), pairs.end(), [](const auto& pair) { return pair.kind == PairKind::kSequential; });
  if (has_sequential && !shares.sequential) return "no two submaps in a row show enough of the same place";
  if (shares.sequential && too_few(*shares.sequential)) {
    return fmt::format("only {:.0f} % of the overlapping sequential pairs could be decided",
                       100.0 * *shares.sequential);
  }
  if (shares.local && too_few(*shares.local)) {
    return fmt::format("only {:.0f} % of the overlapping local pairs could be decided", 100.0 * *shares.local);
  }
  return {};
}

// How many submaps lie outside the largest part that pairs with a bounded disagreement tie together: they may lie
// anywhere. Of a robot without any pair one is counted.
std::size_t untied_submaps(const std::vector<JudgedPair>& pairs, std::size_t robots) {
  std::map<SubmapId, SubmapId> tied_to;
  const auto root = [&](SubmapId at) {
    while (tied_to.at(at) != at) at = tied_to.at(at) = tied_to.at(tied_to.at(at));
    return at;
  };
  std::set<int> seen;
  for (const JudgedPair& pair : pairs) {
    tied_to.try_emplace(pair.id.source, pair.id.source);
    tied_to.try_emplace(pair.id.target, pair.id.target);
    seen.insert({pair.source_robot, pair.target_robot});
  }
  for (const JudgedPair& pair : pairs) {
    if (pair.verdict.verdict == Verdict::kUnverified || !pair.verdict.disagreement_most_m) continue;
    tied_to.at(root(pair.id.source)) = root(pair.id.target);
  }
  std::map<SubmapId, std::size_t> part_sizes;
  for (const auto& [submap, to] : tied_to) ++part_sizes[root(submap)];
  std::size_t largest = 0;
  for (const auto& [part, size] : part_sizes) largest = std::max(largest, size);
  return tied_to.size() - largest + robots - seen.size();
}

// Upper 95 % bounds of all decided pairs, where they tie the map together; the others that overlap are named as
// excluded, and those that are decided without a registration: they are bounded from below only.
void certify(const std::vector<JudgedPair>& pairs, std::size_t robots, MapVerdict& map) {
  for (const JudgedPair& pair : pairs) {
    if (pair.verdict.verdict == Verdict::kUnverified) {
      if (pair.overlaps) map.certificate_excludes.push_back(pair.id);
      continue;
    }
    // The paper's own test measures no interval: it certifies nothing.
    if (!pair.verdict.disagreement_most_m) {
      if (pair.verdict.without_registration) map.certificate_excludes.push_back(pair.id);
      continue;
    }
    if (map.certificate_m.value_or(-1.0) >= *pair.verdict.disagreement_most_m) continue;
    map.certificate_m = *pair.verdict.disagreement_most_m;
    map.certificate_of = pair.id;
  }
  map.untied = untied_submaps(pairs, robots);
  if (map.untied == 0) return;
  map.certificate_m.reset();
  map.certificate_of.reset();
}

}  // namespace

MapVerdict judge_map(std::vector<JudgedPair>& pairs, std::span<const std::string> robots, const JudgeOptions& options) {
  decide_inconsistent(pairs, options);
  MapVerdict map;
  map.log_probability = sum_log_probability(pairs, robots);
  map.decided = decided_shares(pairs, robots);
  map.tested = pairs.size();
  for (const JudgedPair& pair : pairs) {
    map.inconsistent += pair.verdict.verdict == Verdict::kInconsistent ? 1 : 0;
    map.unverified += pair.verdict.verdict == Verdict::kUnverified ? 1 : 0;
  }
  certify(pairs, robots.size(), map);
  const std::string missing = undecided(map.decided, pairs, robots, options);
  if (map.inconsistent > 0) {
    map.state = MapState::kInconsistent;
    map.reason =
        options.method == JudgeMethod::kGamma
            ? fmt::format("{} of {} pairs are verified inconsistent by the paper's test", map.inconsistent, map.tested)
            : fmt::format("{} of {} pairs disagree by more than {:.1f} cm", map.inconsistent, map.tested,
                          100.0 * options.tolerance_m);
  } else if (!missing.empty()) {
    map.state = MapState::kUndetermined;
    map.reason = missing;
  } else {
    map.state = MapState::kConsistent;
    map.reason = options.method == JudgeMethod::kGamma
                     ? std::string("no pair is verified inconsistent by the paper's test, and enough are in line")
                     : fmt::format("no pair is shown to disagree by more than {:.1f} cm, and enough were decided",
                                   100.0 * options.tolerance_m);
  }
  return map;
}

}  // namespace kilter
