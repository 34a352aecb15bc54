// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/ros_messages.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>

#include "kilter/io/pose_reader.h"

namespace kilter {
namespace {

// A stamp, an empty frame and seven numbers; a transform has another name.
constexpr std::size_t kMinStampedPoseBytes = 68;

tl::unexpected<Error> refuse_short(RosType type, const std::string& where) {
  return fail(ErrorCode::kTruncated, fmt::format("the {} message ends before its fields do", name_of(type)), where);
}

std::string frame_of(std::string_view text) {
  if (text.starts_with('/')) text.remove_prefix(1);
  return std::string(text);
}

struct PoseNumbers {
  std::array<double, 3> position_m{};
  std::array<double, 4> xyzw{};
};

PoseNumbers take_pose(MessageCursor& cursor) {
  PoseNumbers numbers;
  for (double& value : numbers.position_m) value = cursor.take<double>();
  for (double& value : numbers.xyzw) value = cursor.take<double>();
  return numbers;
}

std::optional<Pose3> make_pose(const PoseNumbers& numbers) {
  const auto& [x, y, z] = numbers.position_m;
  const auto& [qx, qy, qz, qw] = numbers.xyzw;
  const Eigen::Quaterniond rotation(qw, qx, qy, qz);
  const Eigen::Vector3d position_m(x, y, z);
  // Written so that NaN fails.
  if (!(position_m.cwiseAbs().maxCoeff() <= kMaxPosition_m) || !position_m.allFinite()) return std::nullopt;
  if (!(std::abs(rotation.norm() - 1.0) <= 0.01)) return std::nullopt;
  return Pose3(rotation, position_m);
}

}  // namespace

RosHeader take_header(MessageCursor& cursor) {
  if (cursor.encoding() == MessageEncoding::kRos1) static_cast<void>(cursor.take<std::uint32_t>());  // a counter
  RosHeader header;
  // Unsigned seconds in ROS 1, signed in ROS 2; neither overflows.
  const auto seconds = cursor.take<std::uint32_t>();
  const auto nanoseconds = cursor.take<std::uint32_t>();
  const std::int64_t whole = cursor.encoding() == MessageEncoding::kRos1
                                 ? std::int64_t{seconds}
                                 : std::int64_t{static_cast<std::int32_t>(seconds)};
  header.stamp_ns = 1'000'000'000 * whole + nanoseconds;
  header.frame = frame_of(cursor.take_text());
  return header;
}

Expected<CloudHead> read_cloud_head(std::string_view bytes, MessageEncoding encoding, const std::string& where) {
  Expected<MessageCursor> cursor = MessageCursor::open(bytes, encoding, where);
  if (!cursor) return pass_up(cursor.error());
  CloudHead head;
  head.header = take_header(*cursor);
  const auto height = cursor->take<std::uint32_t>();
  const auto width = cursor->take<std::uint32_t>();
  if (!cursor->ok()) return refuse_short(RosType::kPointCloud2, where);
  head.points = std::uint64_t{height} * width;
  return head;
}

Expected<RosPose> read_ros_pose(std::string_view bytes, RosType type, MessageEncoding encoding,
                                const std::string& where) {
  Expected<MessageCursor> cursor = MessageCursor::open(bytes, encoding, where);
  if (!cursor) return pass_up(cursor.error());
  RosPose pose;
  pose.header = take_header(*cursor);
  if (type == RosType::kOdometry) pose.child_frame = frame_of(cursor->take_text());
  const PoseNumbers numbers = take_pose(*cursor);
  if (!cursor->ok()) return refuse_short(type, where);
  const std::optional<Pose3> made = make_pose(numbers);
  if (!made) {
    return fail(ErrorCode::kInvalidPose,
                fmt::format("expected a finite position and a quaternion of length 1, found {:.3g} {:.3g} {:.3g} and "
                            "{:.3g} {:.3g} {:.3g} {:.3g}",
                            numbers.position_m[0], numbers.position_m[1], numbers.position_m[2], numbers.xyzw[0],
                            numbers.xyzw[1], numbers.xyzw[2], numbers.xyzw[3]),
                where);
  }
  pose.T_frame_child = *made;
  return pose;
}

Expected<RosPoses> read_ros_poses(std::string_view bytes, RosType type, MessageEncoding encoding,
                                  const std::string& where) {
  Expected<MessageCursor> cursor = MessageCursor::open(bytes, encoding, where);
  if (!cursor) return pass_up(cursor.error());
  const bool is_path = type == RosType::kPath;
  const std::string path_frame = is_path ? take_header(*cursor).frame : "";
  const std::uint32_t count = cursor->take_count(kMinStampedPoseBytes);
  if (!cursor->ok()) return refuse_short(type, where);
  RosPoses all;
  for (std::uint32_t i = 0; i < count; ++i) {
    RosPose pose;
    pose.header = take_header(*cursor);
    if (is_path) {
      pose.header.frame = path_frame;
    } else {
      pose.child_frame = frame_of(cursor->take_text());
    }
    const PoseNumbers numbers = take_pose(*cursor);
    if (!cursor->ok()) return refuse_short(type, where);
    if (const std::optional<Pose3> made = make_pose(numbers)) {
      pose.T_frame_child = *made;
      all.poses.push_back(std::move(pose));
    } else {
      ++all.invalid;
    }
  }
  return all;
}

}  // namespace kilter
