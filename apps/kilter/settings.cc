// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/settings.h"

#include <charconv>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "kilter/io/pose_reader.h"

namespace kilter::app {
namespace {

std::string in_quotes(std::string_view text) { return fmt::format("\"{}\"", printable(text, 80)); }

std::string_view take_word(std::string_view& text) {
  constexpr std::string_view kSeparators = " \t,";
  const std::size_t begin = std::min(text.find_first_not_of(kSeparators), text.size());
  const std::size_t end = std::min(text.find_first_of(kSeparators, begin), text.size());
  const std::string_view word = text.substr(begin, end - begin);
  text.remove_prefix(end);
  return word;
}

tl::unexpected<Error> refuse_pose(std::string_view name, const std::string& found, std::string hint = {}) {
  return fail(ErrorCode::kConfig, fmt::format("{}: expected x y z qx qy qz qw, found {}", name, found), {},
              std::move(hint));
}

}  // namespace

Expected<Pose3> pose_from_numbers(const std::vector<double>& numbers, std::string_view name) {
  if (numbers.size() != 7) {
    const bool is_matrix = numbers.size() == 12 || numbers.size() == 16;
    return refuse_pose(
        name, fmt::format("{} numbers", numbers.size()),
        is_matrix ? "of a matrix, its last column x y z, then its rotation as a quaternion qx qy qz qw" : "");
  }
  for (const double number : numbers) {
    if (!std::isfinite(number)) return refuse_pose(name, "a number that is not finite");
  }
  const Eigen::Quaterniond rotation(numbers[6], numbers[3], numbers[4], numbers[5]);
  if (std::abs(rotation.norm() - 1.0) > 0.01) {
    return refuse_pose(name, fmt::format("a quaternion of length {:.3g}, not 1", rotation.norm()));
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (std::abs(numbers[axis]) <= kMaxPosition_m) continue;
    return refuse_pose(name, fmt::format("a position beyond {:g} m: {:g}", kMaxPosition_m, numbers[axis]));
  }
  return Pose3(rotation, Eigen::Vector3d(numbers[0], numbers[1], numbers[2]));
}

Expected<Pose3> parse_pose(std::string_view text, std::string_view name) {
  std::vector<double> numbers;
  for (std::string_view word = take_word(text); !word.empty(); word = take_word(text)) {
    const std::string_view digits = word.front() == '+' ? word.substr(1) : word;
    double number = 0.0;
    const auto [end, status] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (status != std::errc() || end != digits.data() + digits.size()) return refuse_pose(name, in_quotes(word));
    numbers.push_back(number);
  }
  return pose_from_numbers(numbers, name);
}

Expected<OptionField> find_option(Settings& settings, std::string_view key) {
  std::vector<std::string> names = {std::string(kSensorKey)};
  for (OptionField& option : fields(settings.check)) {
    if (option.name == key) return std::move(option);
    names.push_back(option.name);
  }
  const std::string nearest = nearest_name(key, names);
  return fail(
      ErrorCode::kConfig, fmt::format("there is no key {}", in_quotes(key)), {},
      nearest.empty() ? "kilter config show lists every key" : fmt::format("the nearest is {}", in_quotes(nearest)));
}

Expected<void> set_key(Settings& settings, std::string_view key, std::string_view value) {
  if (key == kSensorKey || key.starts_with(std::string(kSensorKey) + '.')) {
    const Expected<Pose3> pose = parse_pose(value);
    if (!pose) return pass_up(pose.error());
    const std::string_view robot = key.substr(std::min(key.size(), kSensorKey.size() + 1));
    settings.T_body_sensor[std::string(robot)] = *pose;
    return {};
  }
  const Expected<OptionField> option = find_option(settings, key);
  if (!option) return pass_up(option.error());
  return option->assign(value);
}

}  // namespace kilter::app
