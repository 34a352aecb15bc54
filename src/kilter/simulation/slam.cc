// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/simulation/slam.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "kilter/base/contract.h"
#include "kilter/simulation/closures.h"
#include "kilter/simulation/fault_plan.h"
#include "kilter/simulation/pose_graph.h"

namespace kilter {
namespace {

using Truth = std::span<const RobotMotion>;
using Poses = std::vector<std::vector<Pose3>>;

enum Stream : std::uint64_t { kOdometry = 1000, kClosures = 2000, kFaults = 3000 };

// Whether its size depends on the rest of the graph, so that it is found by trying.
bool grows_with_drift(FaultKind kind) { return kind == FaultKind::kMissedClosure || kind == FaultKind::kFrameDrift; }

Pose3 true_relative(Truth truth, const ScanRef& a, const ScanRef& b) {
  return truth[a.robot].T_world_sensor[a.scan].inverse() * truth[b.robot].T_world_sensor[b.scan];
}

Pose3 noisy(const Pose3& T, double sigma_m, double sigma_rad, Rng& rng) {
  Vector6 xi;
  for (int i = 0; i < 6; ++i) xi[i] = (i < 3 ? sigma_m : sigma_rad) * rng.normal();
  return T * Pose3::exp(xi);
}

// Everything that was measured, faults included; built anew for each try.
class MissionGraph {
 public:
  MissionGraph(Truth truth, const SlamOptions& options, std::uint64_t seed)
      : truth_(truth), options_(options), seed_(seed), meetings_(find_meetings(truth, options)) {
    std::size_t nodes = 0;
    for (const RobotMotion& robot : truth_) {
      first_node_.push_back(nodes);
      nodes += robot.T_world_sensor.size();
    }
  }

  [[nodiscard]] Expected<Poses> estimate(std::span<const PlannedFault> faults) const {
    PoseGraph graph;
    for (std::size_t r = 0; r < truth_.size(); ++r) add_robot(r, faults, graph);
    add_closures(faults, graph);
    for (const PlannedFault& fault : faults) add_false_closure(fault, graph);
    const Expected<std::vector<Pose3>> relaxed = relax_pose_graph(graph);
    if (!relaxed) return pass_up(relaxed.error());
    Poses poses;
    for (std::size_t r = 0; r < truth_.size(); ++r) {
      const auto begin = relaxed->begin() + static_cast<std::ptrdiff_t>(first_node_[r]);
      poses.emplace_back(begin, begin + static_cast<std::ptrdiff_t>(truth_[r].T_world_sensor.size()));
    }
    return poses;
  }

 private:
  [[nodiscard]] std::size_t node(const ScanRef& ref) const { return first_node_[ref.robot] + ref.scan; }

  // What a fault does to the step that leads to `scan`: a slip all at once, a drift in proportion to the step.
  [[nodiscard]] Vector6 step_error(const PlannedFault& fault, const ScanRef& scan) const {
    if (scan.robot != fault.scan.robot || scan.scan <= fault.first.scan || scan.scan > fault.last.scan) {
      return Vector6::Zero();
    }
    if (fault.request.kind == FaultKind::kSlip) return fault.twist;
    if (!grows_with_drift(fault.request.kind)) return Vector6::Zero();
    const RobotMotion& robot = truth_[scan.robot];
    const double stretch_m = robot.path_m[fault.last.scan] - robot.path_m[fault.first.scan];
    if (stretch_m <= 0.0) return Vector6::Zero();
    Vector6 error = Vector6::Zero();
    error.head<3>() = robot.T_world_sensor[scan.scan].rotation().conjugate() * fault.push_m;
    error[5] = fault.twist[5];
    return (robot.path_m[scan.scan] - robot.path_m[scan.scan - 1]) / stretch_m * error;
  }

  // The robot's start, tied to the first robot's, and its odometry.
  void add_robot(std::size_t r, std::span<const PlannedFault> faults, PoseGraph& graph) const {
    const RobotMotion& robot = truth_[r];
    Pose3 T = robot.T_world_sensor.front();
    Rng rng(seed_, kOdometry + 10 * r);
    if (r > 0) {
      Pose3 T_first_start =
          noisy(true_relative(truth_, {0, 0}, {r, 0}), options_.closure_sigma_m, options_.closure_sigma_rad, rng);
      for (const PlannedFault& fault : faults) {
        if (fault.request.kind != FaultKind::kFrameOffset || fault.scan.robot != r) continue;
        // The displacement is wanted where the robots meet, not where this robot starts.
        const Pose3 T_start_scan = true_relative(truth_, {r, 0}, fault.scan);
        T_first_start = T_first_start * T_start_scan * Pose3::exp(fault.twist) * T_start_scan.inverse();
      }
      T = graph.T_world_node.front() * T_first_start;
      graph.edges.push_back({0, first_node_[r], T_first_start, options_.closure_sigma_m, options_.closure_sigma_rad});
    }
    graph.T_world_node.push_back(T);
    const std::vector<Pose3> odometry =
        drifting_odometry(robot.T_world_sensor, robot.path_m, options_.drift, Rng(seed_, kOdometry + 10 * r + 1));
    for (std::size_t i = 1; i < robot.T_world_sensor.size(); ++i) {
      Pose3 step = odometry[i - 1];
      for (const PlannedFault& fault : faults) step = step * Pose3::exp(step_error(fault, {r, i}));
      T = T * step;
      graph.T_world_node.push_back(T);
      graph.edges.push_back(odometry_edge(r, i, step));
    }
  }

  [[nodiscard]] PoseGraphEdge odometry_edge(std::size_t r, std::size_t i, const Pose3& step) const {
    const double driven_m = truth_[r].path_m[i] - truth_[r].path_m[i - 1];
    const DriftOptions& drift = options_.drift;
    // Deviations of one step; a floor keeps turns on the spot from becoming rigid.
    const double sigma_m = 1e-3 + drift.jitter_m + driven_m * drift.bias_m_per_m.maxCoeff();
    const double sigma_rad = 2e-4 + drift.jitter_rad + driven_m * drift.bias_rad_per_m.maxCoeff() +
                             drift.yaw_rad_per_rad * std::sqrt(step.angle_rad());
    return {first_node_[r] + i - 1, first_node_[r] + i, step, sigma_m, sigma_rad};
  }

  void add_closures(std::span<const PlannedFault> faults, PoseGraph& graph) const {
    Rng rng(seed_, kClosures);
    for (const Meeting& meeting : meetings_) {
      const Pose3 T = noisy(true_relative(truth_, meeting.earlier, meeting.later), options_.closure_sigma_m,
                            options_.closure_sigma_rad, rng);
      const auto rejects = [&](const PlannedFault& fault) { return contradicts(truth_, fault, meeting); };
      if (std::any_of(faults.begin(), faults.end(), rejects)) continue;
      graph.edges.push_back(
          {node(meeting.earlier), node(meeting.later), T, options_.closure_sigma_m, options_.closure_sigma_rad});
    }
  }

  void add_false_closure(const PlannedFault& fault, PoseGraph& graph) const {
    Pose3 T = true_relative(truth_, fault.against, fault.scan);
    if (fault.request.kind == FaultKind::kWrongClosure) {
      T = T * Pose3::exp(fault.twist);
    } else if (fault.request.kind == FaultKind::kMistakenPlace) {
      T = Pose3(T.rotation(), Eigen::Vector3d::Zero());  // believed to stand in the same spot
    } else {
      return;
    }
    graph.edges.push_back(
        {node(fault.against), node(fault.scan), T, options_.closure_sigma_m, options_.closure_sigma_rad});
  }

  Truth truth_;
  const SlamOptions& options_;
  std::uint64_t seed_;
  std::vector<Meeting> meetings_;
  std::vector<std::size_t> first_node_;
};

Vector6 seen_error(Truth truth, const PlannedFault& plan, const Poses& poses) {
  const auto [scan, against] = std::pair(plan.scan, plan.against);
  return relative_error(truth[against.robot].T_world_sensor[against.scan], truth[scan.robot].T_world_sensor[scan.scan],
                        poses[against.robot][against.scan], poses[scan.robot][scan.scan]);
}

Fault measured(Truth truth, const PlannedFault& plan, const Poses& poses) {
  const Vector6 error = seen_error(truth, plan, poses);
  return {plan.request.kind,
          static_cast<int>(plan.scan.robot),
          plan.first.scan,
          plan.scan.scan,
          static_cast<int>(plan.against.robot),
          plan.against.scan,
          error.head<3>().norm(),
          error.tail<3>().norm()};
}

// Pushes drifts towards their asked displacement. \return whether all are within two per cent of its size.
bool tune(Truth truth, std::span<PlannedFault> faults, const Poses& poses) {
  bool settled = true;
  for (PlannedFault& fault : faults) {
    if (!grows_with_drift(fault.request.kind)) continue;
    const Eigen::Vector3d missing_m = (fault.twist - seen_error(truth, fault, poses)).head<3>();
    if (missing_m.norm() < 0.02 * fault.request.size_m) continue;
    settled = false;
    fault.push_m += truth[fault.scan.robot].T_world_sensor[fault.scan.scan].rotation() * missing_m;
  }
  return settled;
}

// Which faults the graph could not take, all of them: more than one may have torn it.
Error with_faults(Error error, Truth truth, std::span<const FaultRequest> requests) {
  if (requests.empty()) return error;
  std::vector<std::string> names;
  for (const FaultRequest& request : requests) {
    names.push_back(fmt::format("{} of {} m (robot {})", to_string(request.kind), request.size_m,
                                truth[static_cast<std::size_t>(request.robot)].name));
  }
  error.message =
      fmt::format("with the fault{} {} {}", names.size() == 1 ? "" : "s", fmt::join(names, ", "), error.message);
  error.hint = "plant smaller faults";
  return error;
}

}  // namespace

Vector6 relative_error(const Pose3& true_a, const Pose3& true_b, const Pose3& estimated_a, const Pose3& estimated_b) {
  return ((true_a.inverse() * true_b).inverse() * (estimated_a.inverse() * estimated_b)).log();
}

Expected<SlamResult> run_slam(Truth truth, std::span<const FaultRequest> requests, const SlamOptions& options,
                              std::uint64_t seed) {
  KILTER_EXPECTS(!truth.empty());
  std::vector<PlannedFault> faults;
  for (std::size_t i = 0; i < requests.size(); ++i) {
    Expected<PlannedFault> fault = plan_fault(truth, requests[i], faults, Rng(seed, kFaults + i));
    if (!fault) return pass_up(fault.error());
    faults.push_back(*fault);
  }
  const MissionGraph mission(truth, options, seed);
  Expected<Poses> poses = mission.estimate(faults);
  constexpr int kMaxTries = 12;
  for (int attempt = 0; poses && attempt < kMaxTries && !tune(truth, faults, *poses); ++attempt) {
    poses = mission.estimate(faults);
  }
  if (!poses) return pass_up(with_faults(poses.error(), truth, requests));
  SlamResult result{std::move(*poses), {}};
  for (const PlannedFault& fault : faults) result.faults.push_back(measured(truth, fault, result.T_world_sensor));
  return result;
}

}  // namespace kilter
