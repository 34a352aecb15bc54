// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <open3d/geometry/PointCloud.h>

#include "methods.h"

namespace kilter {
namespace {

open3d::geometry::PointCloud cloud_of(const Side& side) {
  open3d::geometry::PointCloud cloud;
  for (const Eigen::Vector3f& point_m : side.points_m) cloud.points_.emplace_back(point_m.cast<double>());
  return cloud;
}

}  // namespace

// Makes its tree in every call, and knows no limit.
Method by_open3d(const Side& source, const Side& target) {
  return {"Open3D ComputePointCloudDistance",
          [from = cloud_of(source), onto = cloud_of(target)](std::span<const Pose3> poses,
                                                             std::vector<float>& distances_m, bool /*build*/) {
            for (const Pose3& pose : poses) {
              open3d::geometry::PointCloud now = from;
              now.Transform(pose.isometry().matrix());
              const std::vector<double> found_m = now.ComputePointCloudDistance(onto);
              for (std::size_t i = 0; i < found_m.size(); ++i) {
                distances_m[i] = found_m[i] > kLimit_m ? kNone : static_cast<float>(found_m[i]);
              }
            }
          }};
}

}  // namespace kilter
