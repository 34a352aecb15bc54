// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

#include "kilter/base/expected.h"
#include "kilter/base/parallel.h"
#include "kilter/simulation/simulated_mission.h"

namespace kilter {

enum class ScanFormat { kBin, kPcd };

/// Where and how a simulated mission is written.
struct MissionWriterOptions {
  std::filesystem::path folder;
  ScanFormat format = ScanFormat::kBin;
  bool replace = false;  ///< an earlier mission of ours goes once the new one is whole
  std::string scene;     ///< named in faults.json
  std::uint64_t seed = 1;
};

/// Writes `mission/ROBOT/{poses.tum, scans/000000.bin}`, `truth/ROBOT/poses.tum` and `truth/faults.json`, which get
/// their names when all of it is whole: whatever it returns else, the folder is as it was.
/// Scans are made and written a few at a time, so memory does not grow with the mission.
/// \return kIo or kNoSpace naming the file; what check_room_for_mission fails with; kCancelled.
[[nodiscard]] Expected<void> write_mission(const SimulatedMission& mission, const MissionWriterOptions& options,
                                           const RunContext& run);

/// The text of faults.json: every planted event with robot, scans and measured size.
[[nodiscard]] std::string faults_json(const SimulatedMission& mission, const std::string& scene, std::uint64_t seed);

}  // namespace kilter
