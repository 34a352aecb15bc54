// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "kilter/consistency/consistency_matrix.h"
#include "kilter/consistency/distribution.h"
#include "kilter/consistency/gamma.h"
#include "kilter/geometry/pose3.h"
#include "kilter/pipeline/picture.h"
#include "kilter/submap/fuse_submaps.h"
#include "kilter/submap/submap.h"
#include "kilter/verification/cycles.h"
#include "kilter/verification/frame_offset.h"
#include "kilter/verification/verdict.h"

namespace kilter {

/// A submap as the outside hears of it; its voxels stay inside the run.
struct SubmapSummary {
  SubmapId id;
  std::string name;  ///< "a/1"
  std::string robot;
  int index = 1;                   ///< 1-based
  std::optional<ScanRange> scans;  ///< absent for finished submaps
  Pose3 T_world_submap;
  std::size_t occupied = 0;
  std::size_t bytes = 0;
  std::size_t dropped_points = 0;
};

/// Everything measured and decided about one pair. Absent = not computed, failed or infinite.
struct PairResult {
  PairId id;
  PairKind kind = PairKind::kSequential;
  double overlap = 0.0;
  std::size_t matched = 0;
  double max_distance_m = 1.0;                            ///< the paper's d
  std::optional<DistanceHistogram> histogram;             ///< absent when nothing matched
  std::optional<DistanceHistogram> registered_histogram;  ///< once registered; absent when registration failed
  std::optional<PairScore> score;                         ///< Gamma's; absent when the gate failed
  std::optional<PairScore> registered_score;              ///< Theta's; absent when registration failed
  std::optional<double> theta_oicp_per_m3;                ///< where the paper's registration was run
  std::optional<double> verified;                         ///< Theta - Gamma
  PairVerdict verdict;
  Pose3 T_target_source;  ///< as the map has it
  std::optional<Pose3> T_target_source_registered;
  std::optional<Eigen::Vector3d> centre_target_m;  ///< of the overlap, where offset and open directions are told
  std::optional<Matrix6> covariance;               ///< xi = (x y z rx ry rz) in the source's frame
  bool trusted = false;  ///< registration converged and believed, pair not unverified: goes to g2o
};

/// A fused map that --maps asked for (Eq. 2-3).
struct FusedMap {
  std::string name;  ///< a robot's, or "global"
  std::vector<FusedVoxel> voxels;
};

/// All that `check` found; reports and files are made from this and nothing else.
struct Result {
  double resolution_m = 0.1;
  std::vector<RobotSummary> robots;
  std::vector<SubmapSummary> submaps;  ///< in global numbering
  std::vector<PairResult> pairs;       ///< sorted by PairId
  std::size_t candidates = 0;          ///< pairs whose widened boxes met, sequential ones not counted
  std::size_t too_little_overlap = 0;  ///< of these, neither measured nor predicted overlap passed the gate: not listed
  MapVerdict system;
  CycleClosure cycles;  ///< of the trusted registrations; their covariances are widened by its scale already
  std::vector<FrameOffset> frames;  ///< robots that lie off others as wholes, by numbers of `robots`
  std::vector<FusedMap> maps;
  std::optional<Picture> picture;         ///< if it was asked for
  std::map<std::string, double> seconds;  ///< by stage; differs from run to run

  [[nodiscard]] const SubmapSummary& submap(SubmapId id) const { return submaps[static_cast<std::size_t>(id.value)]; }
};

/// The turn that brings a pair's source to where registration finds it, as a rotation vector along the target's axes:
/// that of T_registered * T_map^-1, its length offset_rad; absent where no offset was measured. [rad]
[[nodiscard]] std::optional<Eigen::Vector3d> offset_rotation_rad(const PairResult& pair);

/// The paper's matrices of a result: Gamma, Theta and Gamma^v (N x N, lower triangle).
[[nodiscard]] ConsistencyMatrix gamma_matrix(const Result& result);
[[nodiscard]] ConsistencyMatrix theta_matrix(const Result& result);
[[nodiscard]] InconsistencyMatrix verified_matrix(const Result& result);

}  // namespace kilter
