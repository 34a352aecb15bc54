// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "kilter/geometry/pose3.h"
#include "kilter/io/bags/bag_contents.h"

namespace kilter {

/// Poses farther apart are not interpolated between: at 1 m/s^2 that is off by 3 cm. [ns]
inline constexpr std::int64_t kMaxPoseGap_ns = 500'000'000;

/// A cloud this close to a pose takes it even before the first, behind the last and inside a longer gap. [ns]
inline constexpr std::int64_t kPoseSlack_ns = 20'000'000;

/// Something in a recording that knows poses over time.
struct PoseSource {
  BagTopic topic;           ///< of transforms: the first topic of moving ones
  std::string frame;        ///< the fixed one
  std::string child_frame;  ///< what the poses are of; empty where nothing says
  std::size_t poses = 0;
  std::int64_t first_ns = 0;
  std::int64_t last_ns = 0;
  /// T_frame_child at a time; nothing where no pose is close enough.
  std::function<std::optional<Pose3>(std::int64_t stamp_ns)> at;
  /// Whether there is a pose of just this time.
  std::function<bool(std::int64_t stamp_ns)> has;
};

/// Everything in a recording that can place clouds of a frame, best first: odometry, stamped poses, the last path,
/// transforms. Of topics of one type, in the order of their names.
/// \param contents  the transforms of the result point into it
[[nodiscard]] std::vector<PoseSource> find_pose_sources(const BagContents& contents, const std::string& cloud_frame);

/// Which clouds have a pose.
struct PoseMatch {
  std::vector<std::size_t> clouds;   ///< indices, rising
  std::vector<Pose3> T_frame_child;  ///< of each
  std::size_t exact = 0;             ///< poses of just the cloud's time
};

[[nodiscard]] PoseMatch match_poses(const PoseSource& source, const std::vector<std::int64_t>& stamps_ns);

/// A source, and the clouds that it places.
struct ChosenPoses {
  PoseSource source;
  PoseMatch match;
};

/// The first kind of source that places at least half as many clouds as any does (a goal that was set by hand is a
/// stamped pose too); of several topics of that kind the one that places most clouds, then the one with most poses of
/// just the clouds' times, then the one with most poses.
///
/// \return  nothing where no cloud is placed.
[[nodiscard]] std::optional<ChosenPoses> choose_poses(const std::vector<PoseSource>& sources,
                                                      const std::vector<std::int64_t>& stamps_ns);

}  // namespace kilter
