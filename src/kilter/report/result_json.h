// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kilter/base/option_table.h"
#include "kilter/geometry/pose3.h"
#include "kilter/pipeline/result.h"

namespace kilter {

/// The schema that result_json follows; docs/result.schema.json describes it.
inline constexpr std::string_view kResultSchema = "kilter.result/1";

/// Every option that can change a result, as it stood in the run.
struct ConfigEcho {
  std::vector<OptionField> options;            ///< the table of CheckOptions
  std::map<std::string, Pose3> T_body_sensor;  ///< by robot, where one was given
};

/// What differs between two runs over the same input: time, place and machine. Nothing else in a result does.
struct RunInfo {
  std::vector<std::string> sources;         ///< as named on the command line
  std::optional<std::string> poses;         ///< --poses
  std::optional<std::string> cuts;          ///< --cuts
  std::optional<std::string> submap_poses;  ///< --submap-poses
  int jobs = 1;                             ///< threads
  std::size_t peak_memory_bytes = 0;        ///< of the whole process
  std::string date;                         ///< ISO 8601, UTC
};

/// 64-bit FNV-1a over the configuration's text and the schema's name, 16 hexadecimal digits: equal for runs whose
/// results compare, whatever file or option the values came from.
[[nodiscard]] std::string config_digest(const ConfigEcho& config);

/// A result as kilter.result/1: every key always there and always in this order; what is absent is null, never 0,
/// NaN or infinity; numbers read back to the same double. Lengths in metres, angles in radians, but for `offset_deg`.
///
/// Equal results, options and run information give equal bytes. O(pairs).
[[nodiscard]] std::string result_json(const Result& result, const ConfigEcho& config, const RunInfo& run);

/// The same without the key `run`: equal for every run over the same input, whenever and wherever it was made.
[[nodiscard]] std::string result_json_without_run(const Result& result, const ConfigEcho& config);

}  // namespace kilter
