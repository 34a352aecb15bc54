// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/geometry/pose3.h"
#include "kilter/pipeline/check.h"

namespace kilter::app {

/// Everything that keys can say.
struct Settings {
  CheckOptions check;
  /// Where poses are the vehicle's: the sensor's place on it, by robot; "" stands for all others.
  std::map<std::string, Pose3> T_body_sensor;
};

/// The key that is no option of a stage: it names robots.
inline constexpr std::string_view kSensorKey = "T_body_sensor";

/// Sets one key from text, as `--set key=value` and the text values of configuration files do: an option of the table,
/// `T_body_sensor` (all robots) or `T_body_sensor.ROBOT` ("x y z qx qy qz qw").
/// \return  kConfig: unknown key (with the nearest), or what OptionField::assign says.
[[nodiscard]] Expected<void> set_key(Settings& settings, std::string_view key, std::string_view value);

/// The option called `key`, bound to `settings`. \return kConfig with the nearest key.
[[nodiscard]] Expected<OptionField> find_option(Settings& settings, std::string_view key);

/// Reads seven numbers, blanks or commas between them, as T_body_sensor; `name` is what messages call them. [m]
/// \return  kConfig when there are not seven finite numbers, or the quaternion is more than 1 % off unit length.
[[nodiscard]] Expected<Pose3> parse_pose(std::string_view text, std::string_view name = kSensorKey);

/// The same from the numbers themselves.
[[nodiscard]] Expected<Pose3> pose_from_numbers(const std::vector<double>& numbers, std::string_view name = kSensorKey);

/// Sets keys from a TOML file: `key = number`, `key = "text"`, `key = true`; T_body_sensor is a list of seven numbers,
/// a text, or a table of those by robot. \return kConfig, with file and line; also when the file cannot be read.
[[nodiscard]] Expected<void> apply_config_file(const std::filesystem::path& file, Settings& settings);

/// The same of a file's text. \param where  its name, for messages
[[nodiscard]] Expected<void> apply_config_text(std::string_view text, const std::string& where, Settings& settings);

}  // namespace kilter::app
