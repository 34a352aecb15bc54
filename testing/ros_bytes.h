// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "testing/cloud_bytes.h"

namespace kilter_testing {

/// How a test's messages are written.
enum class RosDialect { kRos1, kCdrLittle, kCdrBig };

/// Writes a ROS message field by field, as its description orders them.
class RosBytes {
 public:
  explicit RosBytes(RosDialect dialect) : dialect_(dialect) {}

  template <typename T>
  RosBytes& number(T value) {
    if (dialect_ != RosDialect::kRos1) body_.resize((body_.size() + sizeof(T) - 1) / sizeof(T) * sizeof(T));
    put(body_, value, dialect_ == RosDialect::kCdrBig ? std::endian::big : std::endian::little);
    return *this;
  }
  RosBytes& text(const std::string& value) {
    const std::string bytes = dialect_ == RosDialect::kRos1 ? value : value + '\0';
    number(static_cast<std::uint32_t>(bytes.size()));
    body_ += bytes;
    return *this;
  }
  RosBytes& raw(const std::string& bytes) {
    body_ += bytes;
    return *this;
  }
  RosBytes& header(std::int64_t stamp_ns, const std::string& frame) {
    if (dialect_ == RosDialect::kRos1) number(std::uint32_t{7});
    number(static_cast<std::uint32_t>(stamp_ns / 1'000'000'000));
    number(static_cast<std::uint32_t>(stamp_ns % 1'000'000'000));
    return text(frame);
  }
  /// x y z qx qy qz qw
  RosBytes& pose(const std::array<double, 7>& numbers) {
    for (const double value : numbers) number(value);
    return *this;
  }

  [[nodiscard]] std::string str() const {
    if (dialect_ == RosDialect::kRos1) return body_;
    return std::string(dialect_ == RosDialect::kCdrBig ? "\0\0\0\0" : "\0\1\0\0", 4) + body_;
  }

 private:
  RosDialect dialect_;
  std::string body_;
};

inline std::array<double, 7> at_x(double x) { return {x, 0, 0, 0, 0, 0, 1}; }

/// A PointCloud2 of points along x from `first_x`, float32 x y z and an intensity, packed with two bytes between
/// points.
inline std::string cloud_message(RosDialect dialect, std::int64_t stamp_ns, const std::string& frame, int points,
                                 float first_x = 1.0F, bool big_data = false) {
  RosBytes bytes(dialect);
  bytes.header(stamp_ns, frame).number(std::uint32_t{1}).number(static_cast<std::uint32_t>(points));
  const std::array<std::string, 4> names = {"x", "y", "z", "intensity"};
  bytes.number(std::uint32_t{4});
  for (std::uint32_t i = 0; i < 4; ++i) {
    bytes.text(names[i]).number(4 * i).number(std::uint8_t{7}).number(std::uint32_t{1});
  }
  std::string data;
  const std::endian order = big_data ? std::endian::big : std::endian::little;
  for (int i = 0; i < points; ++i) {
    put_all<float>(data, order, first_x + static_cast<float>(i), 2, 3, 0.5);
    data += "..";
  }
  const auto size = static_cast<std::uint32_t>(data.size());
  bytes.number(static_cast<std::uint8_t>(big_data)).number(std::uint32_t{18}).number(size).number(size).raw(data);
  return bytes.number(std::uint8_t{1}).str();
}

inline std::string odometry_message(RosDialect dialect, std::int64_t stamp_ns, const std::string& frame,
                                    const std::string& child, const std::array<double, 7>& pose) {
  RosBytes bytes(dialect);
  bytes.header(stamp_ns, frame).text(child).pose(pose);
  for (int i = 0; i < 36 + 6 + 36; ++i) bytes.number(0.0);
  return bytes.str();
}

inline std::string pose_message(RosDialect dialect, std::int64_t stamp_ns, const std::string& frame,
                                const std::array<double, 7>& pose) {
  return RosBytes(dialect).header(stamp_ns, frame).pose(pose).str();
}

/// A pose with a time.
struct TimedPose {
  std::int64_t stamp_ns = 0;
  std::array<double, 7> pose{};
};

inline std::string path_message(RosDialect dialect, const std::string& frame, const std::vector<TimedPose>& poses) {
  RosBytes bytes(dialect);
  bytes.header(0, frame).number(static_cast<std::uint32_t>(poses.size()));
  for (const TimedPose& pose : poses) bytes.header(pose.stamp_ns, frame).pose(pose.pose);
  return bytes.str();
}

/// T_parent_child at a time.
struct TransformOf {
  std::int64_t stamp_ns = 0;
  std::string parent;
  std::string child;
  std::array<double, 7> pose{};
};

inline std::string transforms_message(RosDialect dialect, const std::vector<TransformOf>& transforms) {
  RosBytes bytes(dialect);
  bytes.number(static_cast<std::uint32_t>(transforms.size()));
  for (const TransformOf& one : transforms) bytes.header(one.stamp_ns, one.parent).text(one.child).pose(one.pose);
  return bytes.str();
}

}  // namespace kilter_testing
