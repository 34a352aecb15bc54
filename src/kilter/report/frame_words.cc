// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/report/frame_words.h"

#include <fmt/format.h>

#include <numbers>

#include "kilter/base/expected.h"
#include "kilter/report/upright_turn.h"

namespace kilter {
namespace {

constexpr double kLeastTurn_deg = 0.05;  // as people are told

std::string turn_words(const Pose3& T) {
  const Eigen::Vector3d turn_deg = T.log().tail<3>() * 180.0 / std::numbers::pi;
  const double angle_deg = turn_deg.norm();
  if (angle_deg < kLeastTurn_deg) return {};
  if (!is_mostly_upright(turn_deg)) return fmt::format(" and all tilted by {:.1f} deg", angle_deg);
  return fmt::format(" and all turned by {:+.1f} deg", turn_deg.z());
}

}  // namespace

std::string frame_words(const Result& result, const FrameOffset& frame) {
  const auto name = [&](int robot) { return printable(result.robots[static_cast<std::size_t>(robot)].name, 24); };
  const Eigen::Vector3d shift_cm = (100.0 * frame.shift_m).array().round() + 0.0;  // and no -0
  return fmt::format(
      "{} as a whole, its middle shifted by x{:+.0f} y{:+.0f} z{:+.0f} cm in world axes{}, would meet {} "
      "in {} of {} pairs",
      name(frame.source_robot), shift_cm.x(), shift_cm.y(), shift_cm.z(), turn_words(frame.T_world_correction),
      name(frame.target_robot), frame.agreeing, frame.witnesses);
}

}  // namespace kilter
