// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/pipeline/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <optional>
#include <utility>

#include "kilter/base/lowest_failure.h"
#include "kilter/pipeline/draw_picture.h"
#include "kilter/pipeline/measure_pairs.h"
#include "kilter/pipeline/reconsider_pairs.h"
#include "kilter/pipeline/submap_store.h"
#include "kilter/registration/uncertainty.h"
#include "kilter/verification/cycles.h"

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
  RunContext context{run.threads, run.cancelled, {}, run.memory_bytes};
  if (run.progress) {
    context.progress = [&run, stage](std::size_t done, std::size_t total) { run.progress(stage, done, total); };
  }
  return context;
}

// What is held of every submap from the beginning to the end; its voxels are in a store.
struct BuiltSubmaps {
  std::vector<SubmapNode> nodes;
  std::vector<CoarseMap> coarse;
  std::vector<SubmapSummary> summaries;
};

// Numbers submaps over all robots: all of the first, then the second, ...
Expected<std::vector<SubmapNode>> plan_all(const std::vector<RobotLog>& robots, const CheckOptions& options,
                                           const std::map<std::string, std::vector<ScanRange>>& cuts) {
  std::vector<SubmapNode> all;
  for (std::size_t robot = 0; robot < robots.size(); ++robot) {
    const auto cut = cuts.find(robots[robot].name);
    const auto ranges = cut == cuts.end() ? std::nullopt : std::optional(cut->second);
    Expected<std::vector<SubmapNode>> nodes =
        plan_submaps(robots[robot], static_cast<int>(robot), options.submap.cutting, ranges);
    if (!nodes) return nodes;
    for (SubmapNode& node : *nodes) {
      node.id = {static_cast<int>(all.size())};
      all.push_back(std::move(node));
    }
  }
  return all;
}

SubmapSummary summary_of(const Submap& submap, const std::string& robot) {
  return {submap.id,
          submap.name,
          robot,
          submap.index + 1,
          submap.scans,
          submap.T_world_submap,
          submap.map.voxels().size(),
          submap.map.bytes(),
          submap.dropped_points};
}

// All robots' submaps side by side; each goes into the store as soon as it is built.
Expected<BuiltSubmaps> build_all(const std::vector<RobotLog>& robots, std::vector<SubmapNode> plan,
                                 const CheckOptions& options, const RunContext& run, SubmapStore& store) {
  BuiltSubmaps built;
  built.nodes = std::move(plan);
  built.coarse.resize(built.nodes.size());
  built.summaries.resize(built.nodes.size());
  LowestFailure failure;
  parallel_for(built.nodes.size(), run, [&](std::size_t i) {
    if (failure.is_before(i)) return;
    const RobotLog& robot = robots[static_cast<std::size_t>(built.nodes[i].robot)];
    Expected<Submap> submap = build_submap(robot, built.nodes[i], options.submap.occupancy, run);
    if (!submap) return failure.keep(i, submap.error());
    built.coarse[i] = CoarseMap(submap->map, kMaxCoarseCells);
    built.summaries[i] = summary_of(*submap, robot.name);
    built.nodes[i] = static_cast<const SubmapNode&>(*submap);
    if (Expected<void> kept = store.add(submap->id, std::move(submap->map)); !kept) failure.keep(i, kept.error());
  });
  if (const auto done = failure.result(); !done) return pass_up(done.error());
  if (run.stop_requested()) return fail(ErrorCode::kCancelled, "stopped while building submaps");
  return built;
}

// Measures all candidates, and those that are listed once more where others contradict them.
Expected<MeasuredPairs> measure_all(const std::vector<SubmapNode>& nodes, const std::vector<CandidatePair>& candidates,
                                    const CheckOptions& options, SubmapStore& store, const CheckRun& run) {
  Expected<MeasuredPairs> measured = measure_pairs(nodes, candidates, options, store, stage_context(run, "pairs"));
  if (!measured || (run.cancelled != nullptr && run.cancelled->load())) return measured;
  if (auto agreed = reconsider_pairs(nodes, store, options, stage_context(run, "agreement"), measured->listed);
      !agreed) {
    return pass_up(agreed.error());
  }
  return measured;
}

// Leaves in `measured` what is heard of neighbours.
std::vector<JudgedPair> judge_all(std::deque<PairMeasurement>& measured, const std::vector<SubmapNode>& nodes,
                                  const CheckOptions& options) {
  std::vector<const PairEvidence*> evidence;
  evidence.reserve(measured.size());
  for (const PairMeasurement& pair : measured) evidence.push_back(&pair.evidence);
  const MapNull null = estimate_null(evidence);
  std::vector<JudgedPair> judged;
  judged.reserve(evidence.size());
  const bool by_gamma = options.judge.method == JudgeMethod::kGamma;
  std::vector<PairVerdict> verdicts;
  if (by_gamma) {
    for (const PairEvidence* pair : evidence) verdicts.push_back(judge_pair_by_gamma(*pair, null));
  } else {
    verdicts = judge_among_neighbours(nodes, null, options, measured);
  }
  for (std::size_t i = 0; i < evidence.size(); ++i) {
    const PairEvidence& pair = *evidence[i];
    const bool overlaps = pair.overlaps && (by_gamma || !shows_no_common_side(pair, null));
    judged.push_back({pair.id, pair.kind, overlaps, nodes[static_cast<std::size_t>(pair.id.source.value)].robot,
                      nodes[static_cast<std::size_t>(pair.id.target.value)].robot, std::move(verdicts[i]),
                      by_gamma || !may_show_different_places(pair, null)});
  }
  return judged;
}

// Covariances come from one pair each, and know nothing of what bends a submap from pair to pair; closed cycles do.
// What nothing fixes keeps the prior's variance, and a bend beyond the tolerance has its own.
CycleClosure widen_covariances(const std::deque<PairMeasurement>& measured, const JudgeOptions& options,
                               std::vector<PairResult>& pairs) {
  const auto rigid = [&](std::size_t i) { return is_rigid(*measured[i].evidence.registration, options); };
  std::vector<RelativePose> poses;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const PairResult& pair = pairs[i];
    if (pair.trusted && rigid(i) && pair.verdict.unobservable.empty())
      poses.push_back({pair.id, *pair.T_target_source_registered, *pair.covariance});
  }
  const CycleClosure closure = close_cycles(poses);
  for (std::size_t i = 0; i < pairs.size() && closure.covariance_scale > 1.0; ++i) {
    if (!pairs[i].covariance) continue;
    pairs[i].covariance = constraint_covariance(*measured[i].evidence.registration, rigid(i), closure.covariance_scale);
  }
  return closure;
}

// Of the registrations that are handed on and fix the whole pose of two rigid submaps.
std::vector<FrameOffset> frame_offsets(const std::deque<PairMeasurement>& measured,
                                       const std::vector<SubmapNode>& nodes, const std::vector<PairResult>& pairs,
                                       const JudgeOptions& options) {
  std::vector<FrameWitness> witnesses;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const std::optional<RegistrationResult>& registration = measured[i].evidence.registration;
    if (!pairs[i].trusted || !pairs[i].verdict.unobservable.empty() || !is_rigid(*registration, options)) continue;
    const SubmapNode& source = nodes[static_cast<std::size_t>(pairs[i].id.source.value)];
    const SubmapNode& target = nodes[static_cast<std::size_t>(pairs[i].id.target.value)];
    const Pose3& T_target_source = registration->T_target_source;
    const Eigen::Vector3d middle_target_m = registration->centre_target_m + registration->places_arm_m;
    const Eigen::Vector3d arm_m = registration->places_arm_m;
    witnesses.push_back({target.robot, source.robot,
                         target.T_world_submap * T_target_source * source.T_world_submap.inverse(),
                         source.T_world_submap * (T_target_source.inverse() * middle_target_m),
                         std::sqrt(std::max(registration->scatter_m2.trace() - arm_m.squaredNorm(), 0.0))});
  }
  return find_frame_offsets(witnesses, options.tolerance_m);
}

void summarise(const std::vector<RobotLog>& robots, BuiltSubmaps& built, Result& result) {
  for (const RobotLog& robot : robots) {
    const std::vector<double> path = path_lengths_m(robot.T_world_cloud);
    result.robots.push_back(
        {robot.name, robot.T_world_cloud.size(), path.empty() ? 0.0 : path.back(), 0, robot.finished_submaps});
  }
  for (const SubmapNode& node : built.nodes) ++result.robots[static_cast<std::size_t>(node.robot)].submaps;
  result.submaps = std::move(built.summaries);
}

Expected<void> fuse_all(const std::vector<SubmapNode>& nodes, SubmapStore& store, const CheckOptions& options,
                        Result& result) {
  const LendMap lend = [&](SubmapId id, const std::function<void(const VoxelMap&)>& use) -> Expected<void> {
    const Expected<PinnedMap> map = store.pin(id);
    if (!map) return pass_up(map.error());
    use((*map)->map());
    return {};
  };
  const auto fuse = [&](std::string name, std::span<const SubmapNode> of) -> Expected<void> {
    Expected<std::vector<FusedVoxel>> voxels = fuse_submaps(of, lend, options.submap.occupancy);
    if (!voxels) return pass_up(voxels.error());
    result.maps.push_back({std::move(name), *std::move(voxels)});
    return {};
  };
  std::size_t first = 0;
  for (const RobotSummary& robot : result.robots) {
    const auto count = static_cast<std::size_t>(robot.submaps);
    if (auto done = fuse(robot.name, std::span(nodes).subspan(first, count)); !done) return done;
    first += count;
  }
  return fuse("global", nodes);
}

tl::unexpected<Error> stopped() { return fail(ErrorCode::kCancelled, "stopped on request; nothing was written"); }

}  // namespace

// Algorithm 1 of the paper, with every candidate accounted for and a verdict that does not rest on Gamma alone.
Expected<Result> check(const std::vector<RobotLog>& robots, const CheckOptions& asked,
                       const std::map<std::string, std::vector<ScanRange>>& cuts, const CheckRun& run) {
  if (auto fit = validate(asked); !fit) return pass_up(fit.error());
  const CheckOptions options = resolved(asked);
  Result result;
  result.resolution_m = options.submap.occupancy.resolution_m;
  Expected<std::vector<SubmapNode>> plan = plan_all(robots, options, cuts);
  if (!plan) return pass_up(plan.error());
  SubmapStore store(plan->size(), search_setup(options), {run.memory_bytes, run.spill});
  BuiltSubmaps submaps;
  {
    const Stopwatch watch(result.seconds["submaps"]);
    Expected<BuiltSubmaps> built = build_all(robots, *std::move(plan), options, stage_context(run, "submaps"), store);
    if (!built) return pass_up(built.error());
    submaps = *std::move(built);
  }
  std::vector<CandidatePair> candidates;
  {
    const Stopwatch watch(result.seconds["pairing"]);
    candidates = propose_pairs(submaps.nodes, submaps.coarse, options.pairing, stage_context(run, "pairing"));
  }
  std::deque<PairMeasurement> measured;
  {
    const Stopwatch watch(result.seconds["pairs"]);
    Expected<MeasuredPairs> all = measure_all(submaps.nodes, candidates, options, store, run);
    if (!all) return pass_up(all.error());
    result.too_little_overlap = all->left_out;
    measured = std::move(all->listed);
  }
  if (run.cancelled != nullptr && run.cancelled->load()) return stopped();
  std::vector<JudgedPair> judged;
  {
    const Stopwatch watch(result.seconds["verdicts"]);
    judged = judge_all(measured, submaps.nodes, options);
  }
  std::vector<std::string> names;
  names.reserve(robots.size());
  for (const RobotLog& robot : robots) names.push_back(robot.name);
  result.system = judge_map(judged, names, options.judge);
  if (judged.empty() && result.too_little_overlap > 0) {
    result.system.reason = fmt::format(
        "nothing to compare: {} near enough to show the same place, but share{} too little of it",
        result.too_little_overlap == 1 ? "1 pair is" : fmt::format("{} pairs are", result.too_little_overlap),
        result.too_little_overlap == 1 ? "s" : "");
  }
  result.candidates = static_cast<std::size_t>(std::count_if(
      candidates.begin(), candidates.end(), [](const auto& pair) { return pair.kind != PairKind::kSequential; }));
  result.pairs.reserve(measured.size());
  for (std::size_t i = 0; i < measured.size(); ++i)
    result.pairs.push_back(pair_result(measured[i], judged[i].verdict, options));
  result.frames = frame_offsets(measured, submaps.nodes, result.pairs, options.judge);
  result.cycles = widen_covariances(measured, options.judge, result.pairs);
  summarise(robots, submaps, result);
  if (run.fuse_maps) {
    const Stopwatch watch(result.seconds["maps"]);
    if (auto done = fuse_all(submaps.nodes, store, options, result); !done) return pass_up(done.error());
  }
  if (run.draw_picture) {
    const Stopwatch watch(result.seconds["picture"]);
    Expected<Picture> picture =
        draw_picture(robots, submaps.nodes, store, result, options.picture, stage_context(run, "picture"));
    if (!picture) return pass_up(picture.error());
    result.picture = *std::move(picture);
  }
  if (run.cancelled != nullptr && run.cancelled->load()) return stopped();
  return result;
}

}  // namespace kilter
