// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/report/unverified_causes.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>

namespace kilter {
namespace {

struct Cause {
  std::string_view says;  // in a reason
  std::string_view name;
};

// The first that fits: what stands further down is said by reasons that also say something further up.
constexpr std::array kCauses = std::to_array<Cause>({
    {"within what odometry may have drifted", "too little overlap, unless odometry drifted as far as it may have"},
    {"ask for another correction", "the pairs around it ask for another correction"},
    {"no registration around it confirms it", "a neighbour's pose, not confirmed"},
    {"ambiguous: ", "ambiguous: another place fits nearly as well"},
    {"registration lost overlap", "registration lost overlap: the places may differ"},
    {"still conflicts", "even once registered the two contradict each other"},
    {"agrees worse than other pairs", "even once registered it agrees worse than other pairs"},
    {"conflicts more there", "where it fits more conflicts: a similar place may be what fits"},
    {"agrees no better there", "it agrees no better where registration puts it"},
    {"no free space speaks against the map", "sees too few common sides"},
    {"too little overlap", "too little overlap"},
    {"nothing in the scene fixes the pose", "nothing in the scene fixes the pose"},
    {"registration failed", "registration failed"},
    {"direction that nothing", "an open direction hides more than the tolerance"},
    {"with what no rigid motion mends", "bent inside, too near the tolerance to be told from it"},
    {"too much for the tolerance", "cells too coarse for the tolerance"},
    {"over the whole map", "too near the tolerance to be told from it over the whole map"},
    {"believed inconsistent before looking", "too near the tolerance for what prior_inconsistent believes"},
    {"too uncertain", "too uncertain to be told from the tolerance"},
    {"too few to compare it with", "too few pairs to compare its Gamma with"},
    {"does not verify it", "Gamma is low, but registration does not verify it"},
    {"Gamma is infinite", "Gamma is infinite: all distances are equal or zero"},
});

std::string without_measurements(std::string_view reason) {
  if (reason.starts_with("offset ")) {
    const std::size_t end = reason.find(')');
    if (end != std::string_view::npos) reason.remove_prefix(end + 1);
    reason.remove_prefix(std::min(reason.find_first_not_of(" ,;:"), reason.size()));
    if (reason.starts_with("but ")) reason.remove_prefix(4);
  }
  reason = reason.substr(0, reason.find(';'));
  std::string cause;
  bool in_number = false;
  bool in_word = false;
  for (const char c : reason) {
    const bool digit = c >= '0' && c <= '9';
    in_word = std::isalpha(static_cast<unsigned char>(c)) != 0 || (digit && in_word);  // log10 is no number
    if (digit && !in_number && !in_word) cause += "..";
    in_number = !in_word && (digit || (in_number && c == '.'));
    if (!in_number) cause += c;
  }
  return cause;
}

}  // namespace

std::string cause_of(std::string_view reason) {
  const auto known = std::find_if(kCauses.begin(), kCauses.end(), [&](const Cause& cause) {
    return reason.find(cause.says) != std::string_view::npos;
  });
  return known != kCauses.end() ? std::string(known->name) : without_measurements(reason);
}

std::vector<std::pair<std::string, std::size_t>> unverified_causes(const Result& result) {
  std::map<std::string, std::size_t> counts;
  for (const PairResult& pair : result.pairs) {
    if (pair.verdict.verdict == Verdict::kUnverified) ++counts[cause_of(pair.verdict.reason)];
  }
  std::vector<std::pair<std::string, std::size_t>> causes(counts.begin(), counts.end());
  std::stable_sort(causes.begin(), causes.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  return causes;
}

}  // namespace kilter
