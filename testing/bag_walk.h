// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "kilter/io/bags/bag_reader.h"
#include "testing/bag_bytes.h"
#include "testing/ros_bytes.h"

namespace kilter_testing {

/// What a walk through a bag came by.
struct Walked {
  std::vector<std::string> messages;  ///< of types that kilter reads, whole, read again by their places
  std::map<std::string, std::size_t> counts;
  std::vector<std::string> notes;
};

inline kilter::Expected<Walked> walk_all(kilter::Expected<std::unique_ptr<kilter::BagReader>> reader) {
  if (!reader) return kilter::pass_up(reader.error());
  Walked walked;
  std::vector<kilter::MessagePlace> places;
  std::vector<std::string> heads;
  const auto done = (*reader)->walk_all([&](const kilter::PassingMessage& message) {
    places.push_back(message.place);
    heads.emplace_back(message.bytes);
  });
  if (!done) return kilter::pass_up(done.error());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto message = (*reader)->read(places[i]);
    if (!message) return kilter::pass_up(message.error());
    EXPECT_TRUE(message->bytes.starts_with(heads[i]));
    walked.messages.emplace_back(message->bytes);
  }
  for (const kilter::BagTopic& topic : (*reader)->topics()) walked.counts[topic.name] += topic.messages;
  walked.notes = (*reader)->notes();
  return walked;
}

/// A drive along x: a cloud each 100 ms of which the n-th begins at x = n, odometry each 50 ms of base in odom, and
/// pictures that nobody reads.
inline std::vector<RecordedMessage> small_drive(RosDialect dialect, int clouds = 4) {
  std::vector<RecordedMessage> messages;
  for (int i = 0; i < 2 * clouds; ++i) {
    const std::int64_t stamp_ns = 1'700'000'000'000'000'000 + std::int64_t{50'000'000} * i;
    const std::string odometry = odometry_message(dialect, stamp_ns, "odom", "lidar", at_x(0.5 * i));
    messages.push_back({"/odom", "nav_msgs/Odometry", stamp_ns + 1000, odometry});
    messages.push_back({"/image", "sensor_msgs/Image", stamp_ns + 2000, std::string(300, 'i')});
    messages.push_back({"/image", "sensor_msgs/Image", stamp_ns + 2000, std::string(300, 'i')});
    messages.push_back({"/image", "sensor_msgs/Image", stamp_ns + 2000, std::string(300, 'i')});
    if (i % 2 == 0) {
      const std::string cloud = cloud_message(dialect, stamp_ns, "lidar", 5, static_cast<float>(i) / 2);
      messages.push_back({"/points", "sensor_msgs/PointCloud2", stamp_ns + 90'000'000, cloud});
    }
  }
  return messages;
}

}  // namespace kilter_testing
