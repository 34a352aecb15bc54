// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace kilter_testing {

/// A message of a test's recording.
struct RecordedMessage {
  std::string topic;
  std::string type;  ///< of ROS 1: "sensor_msgs/PointCloud2"; bags of ROS 2 are given the /msg/ themselves
  std::int64_t log_ns = 0;
  std::string bytes;
};

/// How a test's bag is packed.
enum class BagPacking { kNone, kBz2, kLz4, kZstd };

/// How a test's bag is written, from its format's description.
struct BagLayout {
  BagPacking packing = BagPacking::kNone;
  std::size_t messages_per_chunk = 2;  ///< 0: an MCAP file without chunks
  bool is_closed = true;               ///< whether index or summary stand at the end
  std::string mcap_encoding = "cdr";
};

/// The bytes of a bag of ROS 1, version 2.0.
[[nodiscard]] std::string rosbag1_bytes(const std::vector<RecordedMessage>& messages, const BagLayout& layout = {});

/// The bytes of an MCAP file.
[[nodiscard]] std::string mcap_bytes(const std::vector<RecordedMessage>& messages, const BagLayout& layout = {});

/// Writes a .db3 file of ROS 2.
void write_sqlite_bag(const std::filesystem::path& file, const std::vector<RecordedMessage>& messages);

/// One Zstandard frame.
[[nodiscard]] std::string zstd_bytes(const std::string& bytes);

}  // namespace kilter_testing
