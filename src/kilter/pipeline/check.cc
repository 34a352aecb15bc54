// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/pipeline/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <new>

#include "kilter/pipeline/draw_picture.h"
#include "kilter/pipeline/measure_pair.h"
#include "kilter/pipeline/reconsider_pairs.h"

namespace kilter {
namespace {

class Stopwatch {
 public:
  explicit Stopwatch(double& seconds) : seconds_(seconds) {}
  ~Stopwatch() { seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch(Stopwatch&&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;
  Stopwatch& operator=(Stopwatch&&) = delete;

 private:
  double& seconds_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

RunContext stage_context(const CheckRun& run, std::string_view stage) {
  RunContext context{run.threads, run.cancelled, {}};
  if (run.progress) {
    context.progress = [&run, stage](std::size_t done, std::size_t total) { run.progress(stage, done, total); };
  }
  return context;
}

Expected<void> within_budget(const std::vector<Submap>& submaps, const CheckRun& run) {
  std::size_t held = 0;
  for (const Submap& submap : submaps) held += submap.map.bytes();
  if (run.memory_bytes == 0 || held <= run.memory_bytes) return {};
  return fail(ErrorCode::kOutOfMemory,
              fmt::format("{} submaps need {:.0f} MB, more than --memory allows ({:.0f} MB)", submaps.size(),
                          static_cast<double>(held) / 1e6, static_cast<double>(run.memory_bytes) / 1e6),
              {}, "raise --memory, or use a coarser resolution or a smaller max_range");
}

// Numbers submaps over all robots: all of the first, then the second, ...
Expected<std::vector<Submap>> build_all(const std::vector<RobotLog>& robots, const CheckOptions& options,
                                        const std::map<std::string, std::vector<ScanRange>>& cuts,
                                        const CheckRun& run) {
  std::vector<Submap> all;
  for (std::size_t robot = 0; robot < robots.size(); ++robot) {
    const auto cut = cuts.find(robots[robot].name);
    const auto ranges = cut == cuts.end() ? std::nullopt : std::optional(cut->second);
    Expected<std::vector<Submap>> submaps =
        build_submaps(robots[robot], static_cast<int>(robot), options.submap, stage_context(run, "submaps"), ranges);
    if (!submaps) return pass_up(submaps.error());
    for (Submap& submap : *submaps) {
      submap.id = {static_cast<int>(all.size())};
      all.push_back(std::move(submap));
    }
    const Expected<void> fits = within_budget(all, run);
    if (!fits) return pass_up(fits.error());
  }
  return all;
}

// Measures all candidates and keeps those that are listed; the others are counted.
std::vector<PairMeasurement> measure_all(const std::vector<Submap>& submaps,
                                         const std::vector<CandidatePair>& candidates, const CheckOptions& options,
                                         const SubmapSearches& searches, const CheckRun& run, std::size_t& left_out) {
  std::vector<PairMeasurement> measured(candidates.size());
  parallel_for(candidates.size(), stage_context(run, "pairs"),
               [&](std::size_t i) { measured[i] = measure_pair(submaps, searches, candidates[i], options); });
  left_out = std::erase_if(measured, [](const PairMeasurement& pair) { return !pair.listed; });
  if (run.cancelled == nullptr || !run.cancelled->load()) {
    reconsider_pairs(submaps, searches, options, stage_context(run, "agreement"), measured);
  }
  return measured;
}

std::vector<JudgedPair> judge_all(const std::vector<PairMeasurement>& measured, const std::vector<Submap>& submaps,
                                  const CheckOptions& options) {
  std::vector<PairEvidence> evidence;
  evidence.reserve(measured.size());
  for (const PairMeasurement& pair : measured) evidence.push_back(pair.evidence);
  const MapNull null = estimate_null(evidence);
  std::vector<JudgedPair> judged;
  judged.reserve(evidence.size());
  for (const PairEvidence& pair : evidence) {
    judged.push_back({pair.id, pair.kind, pair.overlaps, submaps[static_cast<std::size_t>(pair.id.source.value)].robot,
                      submaps[static_cast<std::size_t>(pair.id.target.value)].robot,
                      options.judge.method == JudgeMethod::kGamma
                          ? judge_pair_by_gamma(pair, null, options.submap.occupancy.resolution_m)
                          : judge_pair(pair, null, options.judge)});
  }
  return judged;
}

void summarise(const std::vector<RobotLog>& robots, const std::vector<Submap>& submaps, Result& result) {
  for (const RobotLog& robot : robots) {
    const std::vector<double> path = path_lengths_m(robot.T_world_cloud);
    result.robots.push_back(
        {robot.name, robot.T_world_cloud.size(), path.empty() ? 0.0 : path.back(), 0, robot.finished_submaps});
  }
  for (const Submap& submap : submaps) {
    RobotSummary& robot = result.robots[static_cast<std::size_t>(submap.robot)];
    ++robot.submaps;
    result.submaps.push_back({submap.id, submap.name, robot.name, submap.index + 1, submap.scans, submap.T_world_submap,
                              submap.map.voxels().size(), submap.map.bytes(), submap.dropped_points});
  }
}

void fuse_all(const std::vector<Submap>& submaps, const CheckOptions& options, Result& result) {
  std::vector<const Submap*> everyone;
  for (std::size_t robot = 0; robot < result.robots.size(); ++robot) {
    std::vector<const Submap*> own;
    for (const Submap& submap : submaps) {
      if (submap.robot == static_cast<int>(robot)) own.push_back(&submap);
    }
    result.maps.push_back({result.robots[robot].name, fuse_submaps(own, options.submap.occupancy)});
    everyone.insert(everyone.end(), own.begin(), own.end());
  }
  result.maps.push_back({"global", fuse_submaps(everyone, options.submap.occupancy)});
}

tl::unexpected<Error> stopped() { return fail(ErrorCode::kCancelled, "stopped on request; nothing was written"); }

}  // namespace

// Algorithm 1 of the paper, with every candidate accounted for and a verdict that does not rest on Gamma alone.
Expected<Result> check(const std::vector<RobotLog>& robots, const CheckOptions& asked,
                       const std::map<std::string, std::vector<ScanRange>>& cuts, const CheckRun& run) {
  const CheckOptions options = resolved(asked);
  Result result;
  result.resolution_m = options.submap.occupancy.resolution_m;
  std::vector<Submap> submaps;
  {
    const Stopwatch watch(result.seconds["submaps"]);
    Expected<std::vector<Submap>> built = build_all(robots, options, cuts, run);
    if (!built) return pass_up(built.error());
    submaps = std::move(*built);
  }
  std::vector<CandidatePair> candidates;
  {
    const Stopwatch watch(result.seconds["pairing"]);
    candidates = propose_pairs(submaps, options.pairing, stage_context(run, "pairing"));
  }
  std::vector<PairMeasurement> measured;
  SubmapSearches searches;
  {
    const Stopwatch watch(result.seconds["pairs"]);
    searches = build_searches(submaps, options, stage_context(run, "search"));
    measured = measure_all(submaps, candidates, options, searches, run, result.too_little_overlap);
  }
  if (run.cancelled != nullptr && run.cancelled->load()) return stopped();
  std::vector<JudgedPair> judged;
  {
    const Stopwatch watch(result.seconds["verdicts"]);
    judged = judge_all(measured, submaps, options);
  }
  std::vector<std::string> names;
  names.reserve(robots.size());
  for (const RobotLog& robot : robots) names.push_back(robot.name);
  result.system = judge_map(judged, names, options.judge);
  result.candidates = static_cast<std::size_t>(std::count_if(
      candidates.begin(), candidates.end(), [](const auto& pair) { return pair.kind != PairKind::kSequential; }));
  result.pairs.reserve(measured.size());
  for (std::size_t i = 0; i < measured.size(); ++i)
    result.pairs.push_back(pair_result(measured[i], judged[i].verdict, options));
  summarise(robots, submaps, result);
  if (run.fuse_maps) {
    const Stopwatch watch(result.seconds["maps"]);
    fuse_all(submaps, options, result);
  }
  if (run.draw_picture) {
    const Stopwatch watch(result.seconds["picture"]);
    result.picture = draw_picture(robots, submaps, searches, result, options.picture, stage_context(run, "picture"));
  }
  if (run.cancelled != nullptr && run.cancelled->load()) return stopped();
  return result;
}

}  // namespace kilter
