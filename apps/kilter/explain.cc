// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cctype>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/format.h>

#include "apps/kilter/commands.h"
#include "apps/kilter/common_options.h"
#include "apps/kilter/exit_status.h"
#include "apps/kilter/terminal.h"
#include "kilter/base/error_catalog.h"
#include "kilter/io/oddity.h"
#include "kilter/pipeline/check.h"
#include "kilter/report/json_writer.h"
#include "kilter/report/text_lines.h"

namespace kilter::app {
namespace {

struct ExplainCommand {
  CommonOptions common;
  std::string code;
};

struct Topic {
  std::string_view name;
  std::string_view explanation;
};

// Words of the summary and of result.json that are findings, not errors.
constexpr std::array kFindings = {
    Topic{
        "consistent",
        "Of a pair: a disagreement below `tolerance` is established, in every direction in which it could matter; not "
        "merely that none was found. Of the map: no pair is inconsistent, and enough of what overlaps was decided "
        "(`min_decided`) for each kind of pair and each two robots. Exit status 0."},
    Topic{"inconsistent",
          "Of a pair: over the places that both submaps really saw, the map puts the same place farther apart than "
          "`tolerance`, with false discoveries held to `alpha` over the whole map. Of the map: at least one pair is. "
          "Exit status 1."},
    Topic{
        "unverified",
        "Neither consistent nor inconsistent is established for a pair; its `reason` says why: too little overlap, a "
        "registration that failed or is ambiguous, a direction that nothing in the scene fixes, places that changed."},
    Topic{
        "undetermined",
        "No pair is inconsistent, but too little of what overlaps was decided to call the map consistent: robots that "
        "never meet, or too many unverified pairs (`min_decided`). Exit status 4."},
    Topic{"certificate",
          "`certificate_m`: the smallest X for which \"consistent to X m at 95 %\" can be said of the pairs that were "
          "decided. The pairs in `certificate_excludes` overlap too, but nothing can be said about them. There is none "
          "where decided pairs with a bound do not tie all submaps together."},
    Topic{
        "offset",
        "`offset_m`: how far apart the map puts the same place, RMS over the overlap, with its 95 % interval, "
        "registered pose against the map's. Reported whatever the verdict. `offset_vector` is the displacement at the "
        "overlap's centre along the target's axes."},
    Topic{"gap", "`gap_m`: the distance between the two copies of surfaces that the map holds twice (double walls)."},
    Topic{"unobservable",
          "Directions, as unit twists about the overlap's centre, that nothing in the scene fixes: sliding along a "
          "corridor, turning in a round room. A disagreement along them cannot be seen, so the pair is consistent only "
          "if what odometry may have drifted there is below the tolerance."},
    Topic{
        "p-inconsistent",
        "`p_inconsistent`: the probability that a pair's disagreement exceeds the tolerance, from all evidence and the "
        "prior `prior_inconsistent`. Over many pairs said 0.8, eight in ten exceed it. `log_odds` is the same without "
        "saturating."},
    Topic{"conflict",
          "Evidence: the share of what both submaps saw that is a surface to one and free space to the other, at the "
          "map's pose; `conflict_registered` is the same once registered. Beside them what is typical of this map."},
    Topic{"overlap",
          "`overlap` and `matched`: which share of the source's voxels, and how many, have one of the target's within "
          "`d`. The gates `overlap_min` and `matched_min` take the better direction of the two for the share and the "
          "worse for the number; evidence needs them, a verdict may also rest on where the pair would lie after a "
          "drift."},
    Topic{"mean-distance",
          "Evidence `mean_distance_m`: how far the nearest voxel of the other submap is, mean over those that match, "
          "both ways, at the map's pose and once registered."},
    Topic{"displacement", "Evidence: the offset alone, without the bend, beside the tolerance."},
    Topic{
        "disagreement",
        "Evidence: how far apart the map puts the same place, offset and bend together, RMS over the places that both "
        "submaps show. What is asked is whether this exceeds `tolerance`."},
    Topic{
        "bend",
        "Evidence `bend_m`: what still lies apart once registered, since a submap drifted or slipped inside. No rigid "
        "motion mends it; shorter submaps (`submap_distance`) have less of it."},
    Topic{"support",
          "Evidence: how many voxels that face the way moved lie within a quarter voxel of the other's planes, at the "
          "map's pose and once registered. A move that is worth it gathers more."},
    Topic{"same-side",
          "Evidence `same_side`: the share of voxels with one of the other submap's beside it that was seen from the "
          "same side. Where it is low the two may show a floor and the ceiling below it."},
    Topic{"ambiguity",
          "Evidence: how well the next best pose fits, as a share of the best. Above 0.7 the registration is believed "
          "only if others around it agree. Known where the wide search ran."},
    Topic{"agreeing", "Evidence: how many registrations around a pair ask for the same correction, and for another."},
    Topic{
        "covariance",
        "Of a pair's registration: 6x6, of a twist (x y z, then the rotation vector) along the source's axes; what the "
        "scene does not fix has the width that odometry leaves it. `constraints.g2o` holds its inverse, as its reader "
        "wants it."},
    Topic{"kind",
          "Of a pair: sequential (neighbours in a robot's path), local (the same robot, farther apart) or global (two "
          "robots)."},
    Topic{"reason",
          "Why a pair or the map has its `verdict`, in words; of a pair that is unverified, what is missing."},
    Topic{"too-little-overlap",
          "Pairs of submaps near each other, not in a row, that were not tested, since they overlap less than "
          "`overlap_min` and `matched_min` ask for."},
    Topic{"constraint",
          "Whether a pair's registration is handed on as an edge of constraints.g2o: the pair is decided, and by it."},
    Topic{"cycles",
          "Three registrations, chained, have to lead back. What they leave over, against their covariances, says "
          "whether these are too narrow in this map (`covariance_scale`)."},
    Topic{"frames",
          "Robots that lie off others as wholes: one motion of all poses of `source` (`T_world_correction`, from the "
          "left) "
          "that nearly all registrations between the two ask for. Odometry has nothing to do with it: look at how the "
          "two were brought into one frame."},
    Topic{"certificate-of", "`certificate_of`: the pair whose disagreement may be as large as `certificate_m`."},
    Topic{"decided",
          "Which share of the overlapping pairs was decided, by kind and for each two robots. "
          "`min_decided` of each is asked for before a map is called consistent."},
    Topic{"minimum-detectable", "`minimum_detectable_m`: the smallest offset that this pair would have revealed."},
    Topic{"p-value",
          "`p_value`: how often chance would show as much where the disagreement is at most the tolerance. Pairs are "
          "called inconsistent by it, with false discoveries held to `alpha`; it is no probability of being wrong."},
    Topic{"log-odds", "`log_odds`: ln(p / (1 - p)) of `p_inconsistent`, which does not saturate."},
    Topic{
        "gamma",
        "The paper's Eq. (15): 1 / (mean x variance) of the distances between matched voxels, at the map's poses. "
        "Large means consistent. `gamma_literal` is without floors. A parallel offset can score as well as a good "
        "pair, so it is never a verdict by itself. null where fewer than `overlap_min` of the voxels or `matched_min` "
        "of them met, or their distances are no distribution: the paper asks for an overlap first."},
    Topic{
        "mu",
        "`mu`, `sigma`: the normal distribution, cut off at 0 and `d`, that the paper fits to the distances between a "
        "pair's matched voxels; `mu_t`, `var_t`: its mean and variance as cut off, of which Gamma is made."},
    Topic{
        "log-probability",
        "The paper's Eq. (6) and (7): sums of the logarithms of the pairs' probabilities of being consistent, for each "
        "robot, each two robots, and overall."},
    Topic{"theta",
          "Gamma after the pair was registered: as good as it gets for these two submaps. null where registration "
          "failed, or where at its pose the two overlap too little for Gamma."},
    Topic{
        "verified",
        "The paper's Theta - Gamma: what registration gained. Large means inconsistent. null where one of the two is."},
};

std::vector<Topic> topics() {
  std::vector<Topic> all;
  for (const CatalogEntry& entry : error_catalog()) all.push_back({entry.name, entry.explanation});
  for (const OddityTopic& topic : oddity_catalog()) all.push_back({topic.code, topic.explanation});
  all.insert(all.end(), kFindings.begin(), kFindings.end());
  return all;
}

// The topics asked for: one, or all when none is named. Codes are in small letters; what is asked may shout.
Expected<std::vector<Topic>> chosen(std::string code) {
  std::vector<Topic> all = topics();
  if (code.empty()) return all;
  const std::string asked = code;
  for (char& letter : code) {
    letter = letter == '_' ? '-' : static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  }
  // Keys of the result are asked for as they stand there: offset_m, conflict_registered, theta_oicp, log10_gamma.
  for (const std::string_view begin : {"evidence-", "log10-"}) {
    if (code.starts_with(begin)) code.erase(0, begin.size());
  }
  if (code == "matched") code = "overlap";
  if (code == "verdict") code = "reason";
  if (code == "sigma" || code == "mu-t" || code == "var-t") code = "mu";
  if (code == "sequential" || code == "local" || code == "global") code = "kind";
  for (const std::string_view end : {"-log-ratio", "-m", "-interval", "-low", "-high", "-deg", "-x", "-y", "-z",
                                     "-registered", "-excludes", "-literal", "-oicp", "-vector", "-rad", "-scale"}) {
    if (code.size() > end.size() && code.ends_with(end)) code.resize(code.size() - end.size());
  }
  std::vector<std::string> names;
  for (const Topic& topic : all) {
    if (topic.name == code) return std::vector<Topic>{topic};
    names.emplace_back(topic.name);
  }
  CheckOptions keys;
  for (const OptionField& key : fields(keys)) {
    if (key.name != asked) continue;
    return fail(ErrorCode::kUsage, fmt::format("\"{}\" is a key of the configuration: {}", asked, key.doc), {},
                "kilter config show");
  }
  const std::string nearest = nearest_name(code, names);
  return fail(ErrorCode::kUsage, fmt::format("there is no code \"{}\"", printable(asked, 80)), {},
              nearest.empty() ? "kilter explain lists all" : "kilter explain " + nearest);
}

std::string as_json(const std::vector<Topic>& topics) {
  JsonWriter json;
  json.open_object();
  for (const Topic& topic : topics) json.field(topic.name, topic.explanation);
  return json.close().take();
}

std::string as_text(const std::vector<Topic>& topics) {
  std::string text;
  for (const Topic& topic : topics) {
    text += fmt::format("{}\n", topic.name);
    for (const std::string& line : wrapped("  " + std::string(topic.explanation), 100, 2, 20)) text += line + '\n';
  }
  return text;
}

int explain(const ExplainCommand& command) {
  if (const Expected<Settings> settings = read_settings(command.common); !settings) {
    return print_error(settings.error());
  }
  const Expected<std::vector<Topic>> topics = chosen(command.code);
  if (!topics) return print_error(topics.error());
  const Expected<void> done = print_out(command.common.json ? as_json(*topics) : as_text(*topics));
  if (done) return kExitGood;
  print_error(done.error());
  return exit_status_of_output(done.error().code);
}

}  // namespace

void add_explain_command(CLI::App& program, int& status) {
  const auto command = std::make_shared<ExplainCommand>();
  CLI::App* app =
      program.add_subcommand("explain", "what an error or a finding means and what to do; all without CODE");
  app->add_option("CODE", command->code, "the first word of a message, or a word of the result");
  add_common_options(*app, command->common);
  app->callback([command, &status] { status = explain(*command); });
}

}  // namespace kilter::app
