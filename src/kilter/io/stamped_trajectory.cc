// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/stamped_trajectory.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace kilter {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

// No difference of two stamps overflows: they are at most 2^63 - 1 and at least 0, or come from arithmetic in int64.
std::uint64_t between(std::int64_t earlier, std::int64_t later) {
  return static_cast<std::uint64_t>(later) - static_cast<std::uint64_t>(earlier);
}

Pose3 interpolate(const StampedPose& before, const StampedPose& after, std::int64_t stamp_ns) {
  const double share = static_cast<double>(between(before.stamp_ns, stamp_ns)) /
                       static_cast<double>(between(before.stamp_ns, after.stamp_ns));
  const Eigen::Vector3d position_m =
      (1.0 - share) * before.T_world_body.translation_m() + share * after.T_world_body.translation_m();
  return {before.T_world_body.rotation().slerp(share, after.T_world_body.rotation()), position_m};
}

}  // namespace

StampedTrajectory::StampedTrajectory(std::vector<StampedPose> poses) : poses_(std::move(poses)) {
  const auto earlier = [](const StampedPose& a, const StampedPose& b) { return a.stamp_ns < b.stamp_ns; };
  std::stable_sort(poses_.begin(), poses_.end(), earlier);
  const auto same = [](const StampedPose& a, const StampedPose& b) { return a.stamp_ns == b.stamp_ns; };
  poses_.erase(std::unique(poses_.begin(), poses_.end(), same), poses_.end());
}

std::optional<Pose3> StampedTrajectory::at(std::int64_t stamp_ns, std::int64_t max_gap_ns,
                                           std::int64_t slack_ns) const {
  const auto after =
      std::lower_bound(poses_.begin(), poses_.end(), stamp_ns,
                       [](const StampedPose& pose, std::int64_t stamp) { return pose.stamp_ns < stamp; });
  if (after != poses_.end() && after->stamp_ns == stamp_ns) return after->T_world_body;
  const StampedPose* next = after == poses_.end() ? nullptr : &*after;
  const StampedPose* previous = after == poses_.begin() ? nullptr : &*std::prev(after);
  if (previous != nullptr && next != nullptr &&
      between(previous->stamp_ns, next->stamp_ns) <= static_cast<std::uint64_t>(max_gap_ns)) {
    return interpolate(*previous, *next, stamp_ns);
  }
  const auto slack = static_cast<std::uint64_t>(slack_ns);
  if (previous != nullptr && between(previous->stamp_ns, stamp_ns) <= slack) return previous->T_world_body;
  if (next != nullptr && between(stamp_ns, next->stamp_ns) <= slack) return next->T_world_body;
  return std::nullopt;
}

std::optional<std::int64_t> parse_stamp_ns(std::string_view word) {
  constexpr std::int64_t kMaxSeconds = INT64_MAX / kNanosecondsPerSecond - 1;
  const std::size_t point = word.find('.');
  const std::string_view whole = word.substr(0, point);
  std::int64_t seconds = 0;
  if (whole.empty()) return std::nullopt;
  for (const char c : whole) {
    if (c < '0' || c > '9') return std::nullopt;
    seconds = 10 * seconds + (c - '0');
    if (seconds > kMaxSeconds) return std::nullopt;
  }
  std::int64_t nanoseconds = 0;
  std::int64_t unit = kNanosecondsPerSecond / 10;
  for (const char c : point == std::string_view::npos ? std::string_view() : word.substr(point + 1)) {
    if (c < '0' || c > '9') return std::nullopt;
    nanoseconds += unit * (c - '0');
    unit /= 10;  // further digits count nothing
  }
  return seconds * kNanosecondsPerSecond + nanoseconds;
}

}  // namespace kilter
