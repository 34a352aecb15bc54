// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kilter/base/expected.h"
#include "kilter/io/bags/bag_reader.h"
#include "kilter/io/bags/frame_tree.h"
#include "kilter/io/stamped_trajectory.h"

namespace kilter {

/// The files of one recording, in their order.
using BagFiles = std::vector<std::unique_ptr<BagReader>>;

/// Where a cloud lies, and when it was taken.
struct CloudMessage {
  std::int64_t stamp_ns = 0;  ///< its header's
  std::int64_t log_ns = 0;    ///< when it was recorded
  std::uint32_t file = 0;
  MessagePlace place;
  std::uint64_t points = 0;  ///< as its head promises
};

/// Messages that could not be used, and why the first of them.
struct Unusable {
  std::size_t messages = 0;
  std::optional<Error> first;

  void add(Error error) {
    if (messages++ == 0) first = std::move(error);
  }
};

/// The clouds of one topic.
struct CloudTopic {
  BagTopic topic;
  std::string frame;  ///< of the first cloud; those of other frames are left out
  std::vector<CloudMessage> clouds;
  std::size_t other_frames = 0;
  std::size_t unread = 0;  ///< passed over since the budget was used up
  Unusable unusable;
};

/// The poses of one topic: T_frame_child over time.
struct PoseTopic {
  BagTopic topic;
  std::string frame;        ///< of the first pose; those of other frames are left out
  std::string child_frame;  ///< empty where messages do not say
  std::vector<StampedPose> poses;
  std::size_t other_frames = 0;
  Unusable unusable;
};

/// All of a recording that kilter can use; clouds are not read, only found.
struct BagContents {
  std::vector<BagTopic> topics;  ///< of all files, sorted by name
  std::vector<CloudTopic> clouds;
  std::vector<PoseTopic> poses;  ///< of a path the last message
  FrameTree frames;
  std::vector<std::string> transform_topics;
  Unusable unusable_transforms;
};

/// Goes once through all files, which share a budget.
/// \return  what their readers' walks fail with.
[[nodiscard]] Expected<BagContents> read_contents(const BagFiles& files, UnpackingBudget budget = {});

/// Reads a message again, and unpacks it where it was packed by itself (Zstandard, `ros2 bag record --compression-mode
/// message`). May be called from several threads at once.
[[nodiscard]] Expected<MessageBytes> read_message(const BagReader& file, const MessagePlace& place,
                                                  MessageEncoding encoding);

/// "/points (sensor_msgs/PointCloud2, 120)" for each topic, a line each; what is to be done where there is none.
[[nodiscard]] std::string list_topics(std::span<const BagTopic> topics);

}  // namespace kilter
