// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kilter/geometry/pose3.h"
#include "kilter/io/bags/ros_messages.h"
#include "kilter/io/stamped_trajectory.h"

namespace kilter {

/// What /tf and /tf_static say: transforms between frames over time.
class FrameTree {
 public:
  /// Frames between a cloud and the world; no robot has more.
  static constexpr std::size_t kMaxChain = 64;

  /// Adds one transform T_parent_child, parent being its header's frame.
  void add(const RosPose& transform, bool is_static);

  /// To be called once all are added, before anything is asked.
  void finish();

  /// T_a_b by transforms that never change, whichever way they lead; identity where a is b. They are the static ones,
  /// and others that were sent over and over and always said the same: ROS 1 has long sent a sensor's place on /tf.
  [[nodiscard]] std::optional<Pose3> static_between(const std::string& a, const std::string& b) const;

  struct Edge;  ///< a transform between two frames over time

  /// Transforms from a fixed frame down to another one. Points into the tree.
  struct Chain {
    std::string fixed_frame;
    std::vector<const Edge*> edges;  ///< from the moving frame up to the fixed one
    std::size_t samples = 0;         ///< of the transform that was sent most often
    std::int64_t first_ns = 0;       ///< from here to last_ns each of the transforms was sent
    std::int64_t last_ns = 0;
    /// Some transform changes: those that never do hold at any time, however seldom they were sent.
    bool moves = false;
  };

  /// The way from `frame` up to a fixed one: the first of map, odom and world that it meets (with or without a robot's
  /// name in front), else the root. Of several parents of a frame the one that was sent most often counts.
  /// \return  nothing where no transform on the way changes with time.
  [[nodiscard]] std::optional<Chain> chain_from(const std::string& frame) const;

  /// T_fixed_frame at a time, each transform interpolated. `gaps` as in StampedTrajectory::at; a transform of odom may
  /// have longer ones, since it corrects drift and is sent when it has changed.
  [[nodiscard]] std::optional<Pose3> at(const Chain& chain, std::int64_t stamp_ns, std::int64_t max_gap_ns,
                                        std::int64_t slack_ns) const;

  [[nodiscard]] bool empty() const { return parents_of_.empty(); }

 private:
  struct Step {
    std::string frame;
    Pose3 T_frame_start;
  };

  [[nodiscard]] std::vector<Step> static_steps(const std::string& start) const;
  [[nodiscard]] const std::pair<const std::string, Edge>* parent_of(const std::string& frame) const;

  std::map<std::string, std::map<std::string, Edge>> parents_of_;  // by child, by parent
};

struct FrameTree::Edge {
  std::vector<StampedPose> samples;  ///< T_parent_child; of a static transform the last one, which holds at any time
  std::optional<StampedTrajectory> over_time;  ///< of others
  std::optional<Pose3> constant;               ///< T_parent_child of those that never change
  bool is_static = false;
  bool is_correction = false;  ///< the child is odom
};

/// A transform of odom (map to odom, for one) may be this old. [ns]
inline constexpr std::int64_t kMaxCorrectionGap_ns = 10'000'000'000;

/// Whether a frame's name, without a robot's name in front, is `name`: "a/odom" is "odom".
[[nodiscard]] bool is_frame(std::string_view frame, std::string_view name);

}  // namespace kilter
