// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Registers pairs of a mission's submaps from the starts that standard input names, as `check` registers them.
//
//     kilter_registration_benchmark MISSION POSES [KEY=VALUE]...
//
// builds the submaps of MISSION at the poses of the folder POSES and prints them as one line of JSON. Then each line
//
//     METHOD SOURCE TARGET x y z qx qy qz qw
//
// (METHOD: check, search, align or a library's; SOURCE and TARGET: numbers of submaps; the start, T_target_source) is
// answered by one line of JSON, at the end of its batch, which is an empty line: verdicts compare the pairs of one
// batch.
#include <fmt/format.h>

#include <array>
#include <deque>
#include <iostream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "../processor_clock.h"
#include "benchmarks/registration/peers.h"
#include "kilter/io/mission.h"
#include "kilter/pipeline/measure_pair.h"
#include "kilter/report/json_writer.h"

namespace {

using namespace kilter;

struct Try {
  std::string method;
  std::size_t source = 0;
  std::size_t target = 0;
  Pose3 T_target_source_start;
};

// What came of one, by kilter or by another library.
struct Outcome {
  Try asked;
  double seconds = 0.0;
  std::optional<PairMeasurement> measured;
  std::optional<Pose3> T_target_source;
};

Expected<CheckOptions> options_of(const std::vector<std::string>& settings) {
  CheckOptions options;
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    bool known = false;
    for (OptionField& field : fields(options)) {
      if (equals == std::string::npos || field.name != setting.substr(0, equals)) continue;
      if (auto done = field.assign(setting.substr(equals + 1)); !done) return pass_up(done.error());
      known = true;
    }
    if (!known) return fail(ErrorCode::kConfig, "expected KEY=VALUE of a known key", setting);
  }
  return resolved(options);
}

Expected<std::vector<Submap>> submaps_of(const std::string& mission_folder, const std::string& poses_folder,
                                         const CheckOptions& options) {
  MissionOptions how;
  how.poses_folder = poses_folder;
  const Expected<Mission> mission = open_mission({mission_folder}, how);
  if (!mission) return pass_up(mission.error());
  std::vector<Submap> all;
  for (std::size_t robot = 0; robot < mission->robots.size(); ++robot) {
    Expected<std::vector<Submap>> submaps =
        build_submaps(mission->robots[robot], static_cast<int>(robot), options.submap, {});
    if (!submaps) return submaps;
    for (Submap& submap : *submaps) {
      submap.id = {static_cast<int>(all.size())};
      all.push_back(std::move(submap));
    }
  }
  return all;
}

std::string as_line(const std::vector<Submap>& submaps) {
  JsonWriter json;
  json.open_list(JsonWriter::Layout::kCompact);
  for (const Submap& submap : submaps) {
    json.open_object(JsonWriter::Layout::kCompact).field("id", submap.name);
    json.field("robot", submap.name.substr(0, submap.name.find('/'))).field("index", submap.index + 1);
    json.field("first_scan", submap.scans->first).field("last_scan", submap.scans->last);
    json.field("T_world_submap", submap.T_world_submap).field("voxels", submap.map.voxels().size()).close();
  }
  return json.close().take();
}

// As a pair of two robots: nothing but the search distance says how far the start may be off.
CandidatePair candidate_of(const Try& asked) {
  CandidatePair pair;
  pair.id = {{static_cast<int>(asked.source)}, {static_cast<int>(asked.target)}};
  pair.kind = PairKind::kGlobal;
  pair.predicted_enough = true;
  return pair;
}

// The local search alone and what it needs, made anew for this pair, as other libraries make theirs.
std::optional<Pose3> align_alone(const Try& asked, const std::vector<SubmapNode>& nodes,
                                 const std::deque<SearchableMap>& maps, const CheckOptions& options) {
  const double reach_m = options.registration.search_distance_m;
  const NearestVoxelSearch source(maps[asked.source].map(), VoxelPosition::kCentroid, reach_m);
  const NearestVoxelSearch target(maps[asked.target].map(), VoxelPosition::kCentroid, reach_m);
  RegistrationPrior prior;
  prior.up_target = nodes[asked.target].T_world_submap.rotation().conjugate() * Eigen::Vector3d::UnitZ();
  const RegistrationResult result =
      align_submaps(source, target, asked.T_target_source_start, options.registration, prior);
  return result.converged() ? std::optional(result.T_target_source) : std::nullopt;
}

Outcome register_pair(const Try& asked, const std::vector<SubmapNode>& nodes, const std::deque<SearchableMap>& maps,
                      const CheckOptions& options) {
  Outcome outcome{asked, 0.0, std::nullopt, std::nullopt};
  const double begin = processor_seconds();
  if (asked.method == "check" || asked.method == "search") {
    CheckOptions own = options;
    own.registration.always_search = asked.method == "search";
    const Pose3& T_world_target = nodes[asked.target].T_world_submap;
    const Pose3 T_world_source = T_world_target * asked.T_target_source_start;
    outcome.measured = measure_pair({{maps[asked.source], T_world_source}, {maps[asked.target], T_world_target}},
                                    candidate_of(asked), own);
    if (outcome.measured->evidence.registered) {
      outcome.T_target_source = outcome.measured->evidence.registration->T_target_source;
    }
  } else if (asked.method == "align") {
    outcome.T_target_source = align_alone(asked, nodes, maps, options);
  } else {
    outcome.T_target_source =
        align_by_peer(asked.method, maps[asked.source].map(), maps[asked.target].map(), asked.T_target_source_start);
  }
  outcome.seconds = processor_seconds() - begin;
  return outcome;
}

void add_registration(const RegistrationResult& registration, JsonWriter& json) {
  json.field("stop", to_string(registration.stop)).field("searched", registration.searched);
  json.field("ambiguity", registration.ambiguity).field("ambiguous", registration.ambiguous());
  json.field("support_start", registration.support_start).field("support_end", registration.support_end);
  json.field("bend_m", registration.bend.rms_m).field("matches", registration.matches);
  json.key("unobservable").open_list(JsonWriter::Layout::kCompact);
  for (const Vector6& twist : registration.unobservable) json.value(std::span<const double>(twist.data(), 6));
  json.close().key("covariance").value(std::span<const double>(registration.covariance.data(), 36));
}

// Verdicts as if the pairs of the batch were a map.
std::vector<PairVerdict> judge_batch(const std::vector<Outcome>& outcomes, const CheckOptions& options) {
  std::vector<const PairEvidence*> evidence;
  for (const Outcome& outcome : outcomes) {
    if (outcome.measured) evidence.push_back(&outcome.measured->evidence);
  }
  const MapNull null = estimate_null(evidence);
  std::vector<JudgedPair> judged;
  for (const PairEvidence* pair : evidence) {
    judged.push_back({pair->id, pair->kind, pair->overlaps, 0, 1, judge_pair(*pair, null, options.judge)});
  }
  const std::array<std::string, 2> robots = {"target", "source"};
  (void)judge_map(judged, robots, options.judge);
  std::vector<PairVerdict> verdicts;
  for (JudgedPair& pair : judged) verdicts.push_back(std::move(pair.verdict));
  return verdicts;
}

void print_batch(const std::vector<Outcome>& outcomes, const CheckOptions& options) {
  const std::vector<PairVerdict> verdicts = judge_batch(outcomes, options);
  auto verdict = verdicts.begin();
  for (const Outcome& outcome : outcomes) {
    JsonWriter json;
    json.open_object(JsonWriter::Layout::kCompact).field("method", outcome.asked.method);
    json.field("seconds", outcome.seconds).field("T_target_source", outcome.T_target_source);
    if (outcome.measured) {
      const PairEvidence& evidence = outcome.measured->evidence;
      json.field("verdict", to_string(verdict->verdict)).field("reason", verdict->reason);
      json.field("offset_m", verdict->offset_m).field("overlap_at_start", outcome.measured->overlap);
      if (evidence.registration) add_registration(*evidence.registration, json);
      if (evidence.registered) json.field("conflict", evidence.registered->conflict.share());
      ++verdict;
    }
    std::cout << json.close().take();
  }
  std::cout.flush();
}

std::optional<Try> try_of(const std::string& line, std::size_t submaps) {
  std::istringstream words(line);
  Try asked;
  std::array<double, 7> pose{};
  words >> asked.method >> asked.source >> asked.target;
  for (double& number : pose) words >> number;
  if (!words || asked.source >= submaps || asked.target >= submaps) return std::nullopt;
  asked.T_target_source_start =
      Pose3(Eigen::Quaterniond(pose[6], pose[3], pose[4], pose[5]), Eigen::Vector3d(pose[0], pose[1], pose[2]));
  return asked;
}

int answer_tries(std::vector<Submap> submaps, const CheckOptions& options) {
  std::vector<SubmapNode> nodes;
  std::deque<SearchableMap> maps;
  for (Submap& submap : submaps) {
    nodes.push_back(submap);
    maps.emplace_back(std::move(submap.map), search_setup(options));
  }
  std::vector<Outcome> outcomes;
  std::string line;
  while (std::getline(std::cin, line)) {
    if (line.empty()) {
      print_batch(outcomes, options);
      outcomes.clear();
      continue;
    }
    const std::optional<Try> asked = try_of(line, nodes.size());
    if (!asked) {
      fmt::print(stderr, "expected METHOD SOURCE TARGET x y z qx qy qz qw, found: {}\n", line);
      return 2;
    }
    outcomes.push_back(register_pair(*asked, nodes, maps, options));
  }
  return 0;
}

int print_error(const Error& error) {
  fmt::print(stderr, "{}: {}\n", error.where, error.message);
  return 2;
}

}  // namespace

int main(int count, char** words) {
  if (count == 2 && std::string(words[1]) == "--peers") {
    for (const std::string& name : peer_names()) fmt::print("{}\n", name);
    return 0;
  }
  if (count < 3) {
    fmt::print(stderr, "kilter_registration_benchmark MISSION POSES [KEY=VALUE]... | --peers\n");
    return 2;
  }
  const Expected<CheckOptions> options = options_of({words + 3, words + count});
  if (!options) return print_error(options.error());
  Expected<std::vector<Submap>> submaps = submaps_of(words[1], words[2], *options);
  if (!submaps) return print_error(submaps.error());
  std::cout << as_line(*submaps) << std::flush;
  return answer_tries(*std::move(submaps), *options);
}
