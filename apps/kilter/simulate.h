// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/kilter/mission_writer.h"
#include "kilter/simulation/scene.h"

namespace kilter {

/// What `kilter simulate` was asked to do.
struct SimulateRequest {
  std::string scene;
  MissionWriterOptions writer;
  SceneOptions options;
  int beams = 16;
  int columns = 1800;
  double range_noise_m = 0.02;
  double motion_residual = 0.02;
  std::optional<double> scan_step_m;  ///< at least 0.05; absent = the scene's own
  /// Empty = the scene's own; otherwise "none" or KIND[:ROBOT[:SIZE_M[:AT]]] each.
  std::vector<std::string> faults;
};

/// What was made.
struct SimulateSummary {
  std::vector<std::string> robots;
  std::size_t scans = 0;
  std::vector<Fault> faults;
  std::vector<std::string> notes;  ///< on faults of the request whose size came out otherwise
};

/// Makes the mission and writes it. \return kUsage for a scene, fault or lidar that does not exist; see write_mission.
[[nodiscard]] Expected<SimulateSummary> simulate(const SimulateRequest& request, const RunContext& run);

/// Reads "slip", "missed-closure:b:0.8", "slip:a:0.4:0.25"; frame-offset takes no AT. \return kUsage.
[[nodiscard]] Expected<FaultRequest> parse_fault(const std::string& text);

}  // namespace kilter
