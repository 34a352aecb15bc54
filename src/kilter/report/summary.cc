// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/report/summary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "kilter/base/expected.h"
#include "kilter/report/frame_words.h"
#include "kilter/report/text_lines.h"
#include "kilter/report/unverified_causes.h"
#include "kilter/report/worst_pairs.h"

namespace kilter {
namespace {

using Lines = std::vector<std::string>;

constexpr std::size_t kWidth = kSummaryColumns;
constexpr std::size_t kLabel = 12;  // columns of "Robots      "

// "Label      text", wrapped under the text.
void add_labelled(Lines& lines, std::string_view label, std::string_view text, std::size_t max_lines) {
  const Lines block = wrapped(padded(std::string(label), kLabel) + std::string(text), kWidth, kLabel, max_lines);
  lines.insert(lines.end(), block.begin(), block.end());
}

std::string_view headline(MapState state) {
  switch (state) {
    case MapState::kConsistent:
      return "CONSISTENT";
    case MapState::kInconsistent:
      return "INCONSISTENT";
    case MapState::kUndetermined:
      return "UNDETERMINED";
  }
  return "";
}

std::string coloured(std::string_view word, MapState state) {
  const int colour = state == MapState::kConsistent ? 32 : state == MapState::kInconsistent ? 31 : 33;
  return fmt::format("\x1b[1;{}m{}\x1b[0m", colour, word);
}

void add_verdict(Lines& lines, const Result& result, const SummaryOptions& options) {
  const std::string_view word = headline(result.system.state);
  Lines block = wrapped(fmt::format("{}: {}", word, printable(result.system.reason, 400)), kWidth, 2, 2);
  if (options.colour) block[0] = coloured(word, result.system.state) + block[0].substr(word.size());
  lines.insert(lines.end(), block.begin(), block.end());
}

// Rounded down, a certificate would claim more than was shown; 0.00 m of two copies of one robot would, too.
double to_centimetres_above(double metres) { return std::max(0.01, std::ceil(100.0 * metres - 1e-9) / 100.0); }

std::size_t inconsistent_among(const Result& result, const std::vector<PairId>& ids) {
  const std::set<PairId> asked(ids.begin(), ids.end());
  return static_cast<std::size_t>(std::count_if(result.pairs.begin(), result.pairs.end(), [&](const PairResult& pair) {
    return pair.verdict.verdict == Verdict::kInconsistent && asked.contains(pair.id);
  }));
}

void add_certificate(Lines& lines, const Result& result) {
  const MapVerdict& system = result.system;
  std::string text = "none: nothing can be said about the whole map at 95 %";
  if (system.untied > 0 && system.untied < result.submaps.size()) {
    text += fmt::format(", for no decided pair bounds where {} of {} submaps lie{}", system.untied,
                        result.submaps.size(), system.untied == 1 ? "s" : "");
  }
  if (system.certificate_m) {
    text = fmt::format("consistent to {:.2f} m at 95 %", to_centimetres_above(*system.certificate_m));
    if (system.certificate_of) {
      text += fmt::format(" (bounded by {} with {})", printable(result.submap(system.certificate_of->target).name, 20),
                          printable(result.submap(system.certificate_of->source).name, 20));
    }
    if (!system.certificate_excludes.empty()) {
      const PairId first = system.certificate_excludes.front();
      const std::size_t wrong = inconsistent_among(result, system.certificate_excludes);
      text += fmt::format(
          "; says nothing about {} of the pairs that overlap{} ({} with {}{})", system.certificate_excludes.size(),
          wrong > 0 ? fmt::format(", {} of them inconsistent", wrong) : std::string(),
          printable(result.submap(first.target).name, 20), printable(result.submap(first.source).name, 20),
          system.certificate_excludes.size() > 1 ? ", ..." : "");
    }
  }
  add_labelled(lines, "Certified", text, 2);
}

void add_robots(Lines& lines, const Result& result) {
  std::string text;
  for (const RobotSummary& robot : result.robots) {
    if (!text.empty()) text += "; ";
    text += fmt::format("{} ({} {}{}, {:.0f} m, {} submap{})", printable(robot.name, 24), robot.scans,
                        robot.finished_submaps ? "cloud" : "scan", robot.scans == 1 ? "" : "s", robot.path_length_m,
                        robot.submaps, robot.submaps == 1 ? "" : "s");
  }
  add_labelled(lines, "Robots", text, 2);
}

void add_sources(Lines& lines, const std::vector<std::string>& sources) {
  std::string text;
  for (const std::string& source : sources) text += (text.empty() ? "" : "; ") + source;
  if (!text.empty()) add_labelled(lines, sources.size() == 1 ? "Source" : "Sources", text, 1);
}

void add_counts(Lines& lines, const Result& result) {
  if (result.pairs.empty()) return;
  lines.push_back(fmt::format("{:<{}}{:>8}{:>13}{:>14}{:>12}", "Pairs", kLabel, "tested", "consistent", "inconsistent",
                              "unverified"));
  for (const PairKind kind : {PairKind::kSequential, PairKind::kLocal, PairKind::kGlobal}) {
    std::array<std::size_t, 3> by_verdict{};
    for (const PairResult& pair : result.pairs) {
      if (pair.kind == kind) ++by_verdict[static_cast<std::size_t>(pair.verdict.verdict)];
    }
    const std::size_t tested = by_verdict[0] + by_verdict[1] + by_verdict[2];
    if (tested == 0) continue;
    lines.push_back(fmt::format("  {:<{}}{:>8}{:>13}{:>14}{:>12}", to_string(kind), kLabel - 2, tested, by_verdict[0],
                                by_verdict[1], by_verdict[2]));
  }
  if (result.too_little_overlap > 0) {
    const bool one = result.too_little_overlap == 1;
    lines.push_back(fmt::format("  {} more pair{} of submaps near each other share{} too little to be tested",
                                result.too_little_overlap, one ? "" : "s", one ? "s" : ""));
  }
}

// The reasons for saying neither, the commonest first; what finds no room is counted together.
constexpr std::size_t kReasonLines = 3;
void add_reasons(Lines& lines, const Result& result) {
  std::vector<std::pair<std::string, std::size_t>> reasons = unverified_causes(result);
  const std::size_t shown = reasons.size() > kReasonLines ? kReasonLines - 1 : reasons.size();
  std::size_t others = 0;
  for (std::size_t i = shown; i < reasons.size(); ++i) others += reasons[i].second;
  reasons.resize(shown);
  std::string_view label = "Unverified";
  for (const auto& [reason, count] : reasons) {
    add_labelled(lines, std::exchange(label, ""), fmt::format("{} x {}", count, printable(reason, 300)), 1);
  }
  if (others > 0) add_labelled(lines, "", fmt::format("{} x for other reasons", others), 1);
}

// Robots a, b that not one listed pair joins; of thousands, the few that a line can name.
constexpr std::size_t kMostNeverMeet = 8;
std::vector<std::string> robots_that_never_meet(const Result& result) {
  std::set<std::pair<std::string, std::string>> met;
  for (const PairResult& pair : result.pairs) {
    met.emplace(result.submap(pair.id.target).robot, result.submap(pair.id.source).robot);
  }
  std::vector<std::string> never;
  for (std::size_t a = 0; a < result.robots.size(); ++a) {
    for (std::size_t b = a + 1; b < result.robots.size(); ++b) {
      const std::string& first = result.robots[a].name;
      const std::string& second = result.robots[b].name;
      if (never.size() == kMostNeverMeet) return never;
      if (met.contains({first, second})) continue;
      never.push_back(fmt::format("{} and {}", printable(first, 24), printable(second, 24)));
    }
  }
  return never;
}

// A path that may be typed: whole, or as the option's help calls it where no line holds it.
std::string path_or(const std::string& path, std::string_view name) {
  constexpr std::size_t kMostColumns = 70;
  std::string whole = printable(path, 1024);
  return columns_of(whole) <= kMostColumns ? whole : std::string(name);
}

// The same as a word of a command, which lines must not break inside.
std::string word_or(const std::string& path, std::string_view name) {
  const std::string word = shell_word(path_or(path, name));
  return word.find(' ') == std::string::npos ? word : std::string(name);
}

// Bends are mended where they come from: of so many, poses of whole submaps are no cure.
constexpr double kManyBent = 1.0 / 3.0;
std::string where_bends_come_from(const Result& result) {
  const auto bent =
      static_cast<std::size_t>(std::count_if(result.pairs.begin(), result.pairs.end(), [](const PairResult& pair) {
        return pair.verdict.verdict == Verdict::kInconsistent && !pair.verdict.rigid;
      }));
  if (bent == 0 || static_cast<double>(bent) < kManyBent * static_cast<double>(result.system.inconsistent)) return {};
  return fmt::format(
      "{} of the {} are bent inside: see to stamps, de-skewing, T_body_sensor and slips within submaps first; then ",
      bent, result.system.inconsistent);
}

// Of the inconsistent pairs, those that gave a constraint.
std::string how_to_mend(const Result& result, const SummaryOptions& options, const std::string& folder) {
  std::size_t constraints = 0;
  for (const PairResult& pair : result.pairs) {
    constraints += pair.verdict.verdict == Verdict::kInconsistent && pair.trusted ? 1 : 0;
  }
  if (constraints == 0) {
    return fmt::format(
        "no correction of a pair that disagrees can be believed, so {0}/constraints.g2o does not mend it; the column "
        "`reason` of {0}/pairs.csv says why",
        folder);
  }
  const std::string few = 2 * constraints < result.system.inconsistent
                              ? fmt::format(" (constraints for {} of the {})", constraints, result.system.inconsistent)
                              : std::string();
  const bool are_cut = std::any_of(result.submaps.begin(), result.submaps.end(),
                                   [](const SubmapSummary& submap) { return submap.scans.has_value(); });
  return where_bends_come_from(result) +
         fmt::format(
             "give {0}/constraints.g2o{1} to the optimiser, then check the same again with --submap-poses NEW.g2o{2}",
             folder, few,
             (are_cut ? " --cuts " + word_or(options.output_folder, "OUT") : std::string()) +
                 (options.poses ? " --poses " + word_or(*options.poses, "DIR") : std::string()));
}

// Robots whose scans leave no surface to any submap.
std::vector<std::string> robots_without_surface(const Result& result) {
  std::set<std::string> with_surface;
  for (const SubmapSummary& submap : result.submaps) {
    if (submap.occupied > 0) with_surface.insert(submap.robot);
  }
  std::vector<std::string> without;
  for (const RobotSummary& robot : result.robots) {
    if (!robot.finished_submaps && !with_surface.contains(robot.name)) without.push_back(printable(robot.name, 24));
  }
  return without;
}

std::size_t likelier_than_not(const Result& result) {
  return static_cast<std::size_t>(std::count_if(result.pairs.begin(), result.pairs.end(), [](const PairResult& pair) {
    return pair.verdict.verdict == Verdict::kUnverified && pair.verdict.p_inconsistent.value_or(0.0) > 0.5;
  }));
}

std::string next_step(const Result& result, const SummaryOptions& options, bool some_never_meet) {
  const std::string folder = path_or(options.output_folder, "OUT");
  if (!options.odd.empty()) {
    return fmt::format("see to the input first ({}): with that, what stands above may mean nothing", options.odd);
  }
  switch (result.system.state) {
    case MapState::kConsistent:
      if (options.papers_test) return "the paper's test compares pairs with each other, not with a length in metres";
      if (const std::size_t likely = likelier_than_not(result); likely > 0) {
        return fmt::format(
            "{} undecided pair{} likelier disagree{} than not: look at {}/pairs.csv where p_inconsistent is above 0.5",
            likely, likely == 1 ? "" : "s", likely == 1 ? "s" : "", folder);
      }
      return fmt::format("nothing to mend above {:.2f} m; a smaller tolerance asks for more", options.tolerance_m);
    case MapState::kInconsistent:
      return how_to_mend(result, options, folder);
    case MapState::kUndetermined:
      if (const std::vector<std::string> without = robots_without_surface(result); !without.empty()) {
        return fmt::format("widen min_range and max_range: they leave no surface to any submap of {}",
                           fmt::join(without, ", "));
      }
      if (result.pairs.empty() && result.too_little_overlap > 0) {
        const bool one = result.too_little_overlap == 1;
        return fmt::format(
            "{} pair{} near enough to show the same place, but share{} less than overlap_min and matched_min ask for: "
            "lower these, or take finer voxels (resolution)",
            result.too_little_overlap, one ? " is" : "s are", one ? "s" : "");
      }
      if (result.submaps.size() < 2) {
        return "one submap has nothing to be compared with: shorter submaps (submap_distance) make more of a short way";
      }
      if (result.pairs.empty()) return "a map can only be compared with itself where it shows a place twice";
      return some_never_meet ? "send robots that never meet through a place that both see, or check them one by one"
                             : fmt::format("the column `reason` of {}/pairs.csv says what each pair lacks", folder);
  }
  return {};
}

void add_frames(Lines& lines, const Result& result) {
  constexpr std::size_t kMost = 2;
  for (std::size_t i = 0; i < std::min(result.frames.size(), kMost); ++i) {
    std::string words = frame_words(result, result.frames[i]);
    if (i + 1 == kMost && result.frames.size() > kMost) {
      words += fmt::format("; {} more in result.json", result.frames.size() - kMost);
    }
    add_labelled(lines, "Frames", words, 2);
  }
}

}  // namespace

std::string summary(const Result& result, const SummaryOptions& options) {
  Lines lines;
  add_verdict(lines, result, options);
  add_certificate(lines, result);
  add_sources(lines, options.sources);
  add_robots(lines, result);
  add_counts(lines, result);
  add_reasons(lines, result);
  const std::vector<std::string> never = robots_that_never_meet(result);
  if (!never.empty()) add_labelled(lines, "Never meet", fmt::format("{}", fmt::join(never, "; ")), 1);
  add_frames(lines, result);
  const Lines worst = worst_pair_lines(result, options.papers_test, kWidth);
  lines.insert(lines.end(), worst.begin(), worst.end());
  add_labelled(lines, "Next", next_step(result, options, !never.empty()), 4);
  return fmt::format("{}\n", fmt::join(lines, "\n"));
}

}  // namespace kilter
