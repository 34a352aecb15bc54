// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "kilter/geometry/pose3.h"

namespace kilter {

/// What one registration between two robots asks for: all of the source's robot moved by `T_world_correction` from the
/// left, the other one held.
struct FrameWitness {
  int target_robot = 0;
  int source_robot = 0;
  Pose3 T_world_correction;
  Eigen::Vector3d middle_world_m = Eigen::Vector3d::Zero();  ///< of what both saw, as the source has it in the map
  double radius_m = 0.0;                                     ///< RMS distance of what both saw from its middle
};

/// One motion that brings one robot's whole map onto another's.
struct FrameOffset {
  int target_robot = 0;
  int source_robot = 0;
  Pose3 T_world_correction;
  Eigen::Vector3d middle_world_m = Eigen::Vector3d::Zero();  ///< of what all that agree saw, as the source has it
  Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();         ///< of that middle, world axes
  double offset_m = 0.0;                                     ///< RMS by which it moves what they saw
  std::size_t agreeing = 0;                                  ///< witnesses that it leaves at most the tolerance off
  std::size_t witnesses = 0;                                 ///< registrations between the two that fix the whole pose
};

/// Pairs of robots whose frames lie apart as wholes: at least three registrations between the two and four fifths of
/// all agree with one motion to `tolerance_m` (RMS over what each pair saw), and it moves that by more than the
/// tolerance. Where odometry drifted or slipped on the way, pairs ask for different motions, and nothing is said. The
/// motion is the rigid fit to what those that agree ask for.
/// \return sorted by target, then source robot. O(n) for each of at most 256 motions tried between two robots.
[[nodiscard]] std::vector<FrameOffset> find_frame_offsets(std::span<const FrameWitness> witnesses, double tolerance_m);

}  // namespace kilter
