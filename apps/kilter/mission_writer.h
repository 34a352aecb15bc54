// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "kilter/base/expected.h"
#include "kilter/base/parallel.h"
#include "kilter/simulation/simulated_mission.h"

namespace kilter::app {

enum class ScanFormat { kBin, kPcd };

/// Where and how a simulated mission is written.
struct MissionWriterOptions {
  std::filesystem::path folder;
  ScanFormat format = ScanFormat::kBin;
  bool replace = false;    ///< remove an earlier mission's `mission/` and `truth/` first
  std::string scene;       ///< named in faults.json
  std::uint64_t seed = 1;  ///< likewise
};

/// Writes `mission/ROBOT/{poses.tum, scans/000000.bin}`, `truth/ROBOT/poses.tum` and, last, `truth/faults.json`.
/// Scans are made and written a few at a time, so memory does not grow with the mission.
/// \return kIo or kNoSpace naming the file; kUsage when the folder holds a mission already; kCancelled.
[[nodiscard]] Expected<void> write_mission(const SimulatedMission& mission, const MissionWriterOptions& options,
                                           const RunContext& run);

/// The text of faults.json: every planted event with robot, scans and the size that the estimate shows.
[[nodiscard]] std::string faults_json(const SimulatedMission& mission, const MissionWriterOptions& options);

}  // namespace kilter::app
