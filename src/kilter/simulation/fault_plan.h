// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "kilter/base/rng.h"
#include "kilter/simulation/closures.h"
#include "kilter/simulation/fault.h"

namespace kilter {

/// A requested fault with its place in this mission.
struct PlannedFault {
  FaultRequest request;
  ScanRef first;                    ///< the error grows on the steps after this scan
  ScanRef last;                     ///< up to this one
  ScanRef scan;                     ///< the error is looked at here
  ScanRef against;                  ///< where the error can be seen: the scan it is compared with
  Vector6 twist = Vector6::Zero();  ///< what is to be seen at `scan`, in its frame

  /// Drifts only: what pushes the robot aside all along, so that the translation of `twist` results. World frame.
  Eigen::Vector3d push_m = Eigen::Vector3d::Zero();
};

/// Finds the place in the mission that fits a request and draws what it leaves open. A frame's error is looked at
/// where no fault of `earlier` has yet touched the other robot, if there is such a place.
/// \return kInvalidArgument when there is none.
[[nodiscard]] Expected<PlannedFault> plan_fault(std::span<const RobotMotion> truth, const FaultRequest& request,
                                                std::span<const PlannedFault> earlier, Rng rng);

/// Whether a closure would contradict the fault, so that a robust back end leaves it out.
[[nodiscard]] bool contradicts(std::span<const RobotMotion> truth, const PlannedFault& fault, const Meeting& meeting);

}  // namespace kilter
