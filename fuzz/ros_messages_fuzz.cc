// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// Any bytes taken for a ROS message (the first one says which type and encoding) are refused with a printable reason,
// or give points and poses that can be used.
#include <cmath>

#include "kilter/io/bags/point_cloud2.h"
#include "kilter/io/bags/ros_messages.h"
#include "kilter/io/pose_reader.h"
#include "reader_laws.h"

namespace {

void demand_sound(const kilter::RosPose& pose) {
  kilter_fuzz::demand(pose.T_frame_child.translation_m().cwiseAbs().maxCoeff() <= kilter::kMaxPosition_m);
  kilter_fuzz::demand(std::abs(pose.T_frame_child.rotation().norm() - 1.0) < 1e-12);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using kilter::RosType;
  if (size == 0) return 0;
  const std::string_view bytes = kilter_fuzz::text_of(data + 1, size - 1);
  const auto encoding = (data[0] & 8) != 0 ? kilter::MessageEncoding::kCdr : kilter::MessageEncoding::kRos1;
  const auto type = static_cast<RosType>(data[0] % 8 % 7);
  if (const auto head = kilter::read_cloud_head(bytes, encoding, "fuzz"); !head) {
    kilter_fuzz::demand_printable(head.error());
  }
  if (type == RosType::kPath || type == RosType::kTransforms) {
    const auto poses = kilter::read_ros_poses(bytes, type, encoding, "fuzz");
    if (!poses) return kilter_fuzz::demand_printable(poses.error()), 0;
    kilter_fuzz::demand(68 * (poses->poses.size() + poses->invalid) <= size);
    for (const kilter::RosPose& pose : poses->poses) demand_sound(pose);
  } else if (type == RosType::kPointCloud2 || type == RosType::kOther) {
    kilter_fuzz::demand_usable(kilter::read_point_cloud2(bytes, encoding, "fuzz"), size);
  } else {
    const auto pose = kilter::read_ros_pose(bytes, type, encoding, "fuzz");
    if (!pose) return kilter_fuzz::demand_printable(pose.error()), 0;
    demand_sound(*pose);
  }
  return 0;
}
