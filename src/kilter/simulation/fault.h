// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace kilter {

/// What can go wrong in a simulated mission. Each is one event in the odometry or in the pose graph.
enum class FaultKind {
  kSlip,           ///< one step of odometry is off, at a sharp turn
  kMissedClosure,  ///< drift over a stretch of path, and the robot does not recognise where it comes back to
  kFrameOffset,    ///< a robot starts from a wrong place and never recognises the others' places
  kFrameDrift,     ///< a robot drifts away from the others' frame all along
  kWrongClosure,   ///< a closure with a wrong offset bends a map that was good
  kMistakenPlace,  ///< a place is taken for another that looks like it
};

/// "slip", "missed-closure", ... as on the command line and in faults.json.
[[nodiscard]] std::string_view to_string(FaultKind kind);

/// The kind of that name, if there is one.
[[nodiscard]] std::optional<FaultKind> fault_kind_from(std::string_view name);

/// An event to plant. Shares are of the robot's scans, in [0, 1].
struct FaultRequest {
  FaultKind kind = FaultKind::kSlip;
  int robot = 0;  ///< 0-based
  /// kMissedClosure: where the drift sets in; kMissedClosure, kWrongClosure: the robot comes back to a scan up to here.
  double from = 0.3;
  double until = 1.0;     ///< kMissedClosure, kFrameDrift: where the drift ends, if not where the error is looked at
  double at = 0.6;        ///< where the event is, or from where on the robot may come back or meet; not of kFrameOffset
  double size_m = 0.4;    ///< displacement; kMistakenPlace: how far the two places are apart
  double size_rad = 0.0;  ///< yaw
  /// Of the displacement, from the robot's x axis at the event. When absent, it and the sign of the yaw are drawn.
  std::optional<double> bearing_rad = {};
  bool at_turn = true;  ///< kSlip: move to the sharpest turn within a tenth of the robot's scans
};

/// An event as it shows in the finished estimate.
struct Fault {
  FaultKind kind = FaultKind::kSlip;
  int robot = 0;
  std::size_t first_scan = 0;  ///< the error begins to grow here
  std::size_t scan = 0;        ///< and is seen here,
  int against_robot = 0;       ///< compared with this scan
  std::size_t against_scan = 0;
  /// Estimated relative pose of the two scans against the true one, at `scan`.
  double size_m = 0.0;
  double size_rad = 0.0;
};

}  // namespace kilter
