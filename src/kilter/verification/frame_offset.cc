// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/verification/frame_offset.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

namespace kilter {
namespace {

constexpr std::size_t kFewestAgreeing = 3;
constexpr double kLeastShare = 0.8;
constexpr std::size_t kMostTried = 256;

using Witnesses = std::vector<const FrameWitness*>;

// Points that stand for what a pair saw: six about the middle, of the same RMS distance from it.
std::array<Eigen::Vector3d, 6> places_of(const FrameWitness& witness) {
  const double r_m = witness.radius_m;
  const Eigen::Vector3d& c_m = witness.middle_world_m;
  return {c_m + Eigen::Vector3d(r_m, 0, 0), c_m - Eigen::Vector3d(r_m, 0, 0), c_m + Eigen::Vector3d(0, r_m, 0),
          c_m - Eigen::Vector3d(0, r_m, 0), c_m + Eigen::Vector3d(0, 0, r_m), c_m - Eigen::Vector3d(0, 0, r_m)};
}

// RMS over a pair's places between where two motions put them.
double apart_m(const FrameWitness& at, const Pose3& a, const Pose3& b) {
  double squares = 0.0;
  const auto places_m = places_of(at);
  for (const Eigen::Vector3d& place_m : places_m) squares += (a * place_m - b * place_m).squaredNorm();
  return std::sqrt(squares / static_cast<double>(places_m.size()));
}

Witnesses agreeing_with(const Pose3& motion, const Witnesses& all, double tolerance_m) {
  Witnesses agreeing;
  std::copy_if(all.begin(), all.end(), std::back_inserter(agreeing), [&](const FrameWitness* witness) {
    return apart_m(*witness, motion, witness->T_world_correction) <= tolerance_m;
  });
  return agreeing;
}

// The rigid motion nearest to what they all ask for (Umeyama 1991, without scale).
Pose3 fit_to(const Witnesses& witnesses) {
  Eigen::Matrix3Xd from_m(3, 6 * witnesses.size());
  Eigen::Matrix3Xd onto_m(3, 6 * witnesses.size());
  Eigen::Index column = 0;
  for (const FrameWitness* witness : witnesses) {
    for (const Eigen::Vector3d& place_m : places_of(*witness)) {
      from_m.col(column) = place_m;
      onto_m.col(column++) = witness->T_world_correction * place_m;
    }
  }
  const Eigen::Matrix4d T = Eigen::umeyama(from_m, onto_m, false);
  return {Eigen::Quaterniond(Eigen::Matrix3d(T.topLeftCorner<3, 3>())), T.topRightCorner<3, 1>()};
}

std::optional<FrameOffset> offset_between(const Witnesses& all, double tolerance_m) {
  Witnesses best;
  const std::size_t step = std::max<std::size_t>(1, (all.size() + kMostTried - 1) / kMostTried);
  for (std::size_t k = 0; k < all.size(); k += step) {
    Witnesses agreeing = agreeing_with(all[k]->T_world_correction, all, tolerance_m);
    if (agreeing.size() > best.size()) best = std::move(agreeing);
  }
  if (best.size() < kFewestAgreeing) return std::nullopt;
  FrameOffset found;
  found.T_world_correction = fit_to(best);
  best = agreeing_with(found.T_world_correction, all, tolerance_m);
  found.agreeing = best.size();
  found.witnesses = all.size();
  if (found.agreeing < kFewestAgreeing ||
      static_cast<double>(found.agreeing) < kLeastShare * static_cast<double>(found.witnesses)) {
    return std::nullopt;
  }
  found.target_robot = all.front()->target_robot;
  found.source_robot = all.front()->source_robot;
  const auto count = static_cast<double>(best.size());
  double squares = 0.0;
  for (const FrameWitness* witness : best) {
    found.middle_world_m += witness->middle_world_m / count;
    const double moved_m = apart_m(*witness, found.T_world_correction, Pose3());
    squares += moved_m * moved_m / count;
  }
  found.shift_m = found.T_world_correction * found.middle_world_m - found.middle_world_m;
  found.offset_m = std::sqrt(squares);
  return found.offset_m > tolerance_m ? std::optional(found) : std::nullopt;
}

}  // namespace

std::vector<FrameOffset> find_frame_offsets(std::span<const FrameWitness> witnesses, double tolerance_m) {
  std::map<std::pair<int, int>, Witnesses> by_robots;
  for (const FrameWitness& witness : witnesses) {
    if (witness.target_robot == witness.source_robot) continue;
    by_robots[{witness.target_robot, witness.source_robot}].push_back(&witness);
  }
  std::vector<FrameOffset> offsets;
  for (const auto& [robots, of_two] : by_robots) {
    if (const auto found = offset_between(of_two, tolerance_m)) offsets.push_back(*found);
  }
  return offsets;
}

}  // namespace kilter
