// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "kilter/geometry/pose3.h"

namespace kilter {

/// Where something was at a time.
struct StampedPose {
  std::int64_t stamp_ns = 0;  ///< Unix time, or since any other zero that clouds share
  Pose3 T_world_body;
};

/// Poses in order of time, asked for times between them.
class StampedTrajectory {
 public:
  /// Sorts by time; of several poses at one time the first given stays.
  explicit StampedTrajectory(std::vector<StampedPose> poses);

  [[nodiscard]] std::span<const StampedPose> poses() const { return poses_; }

  /// The pose at a time: that of the stamp itself, or between its two neighbours (position linearly, rotation along
  /// the shortest arc) if they lie at most `max_gap_ns` apart.
  /// \return  nothing before the first, behind the last or inside a longer gap; a stamp at most `slack_ns` away from a
  ///          neighbour takes that neighbour's pose even there. O(log n).
  [[nodiscard]] std::optional<Pose3> at(std::int64_t stamp_ns, std::int64_t max_gap_ns, std::int64_t slack_ns) const;

 private:
  std::vector<StampedPose> poses_;
};

/// A stamp in seconds as text ("1403636579.763555584") without a double's rounding; up to nine digits behind the point
/// count. Nothing for what is not such a number, is negative or beyond the year 2262.
[[nodiscard]] std::optional<std::int64_t> parse_stamp_ns(std::string_view word);

}  // namespace kilter
