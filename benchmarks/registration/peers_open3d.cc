// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "benchmarks/registration/peers_open3d.h"

#include <open3d/geometry/KDTreeSearchParam.h>
#include <open3d/geometry/PointCloud.h>
#include <open3d/pipelines/registration/GeneralizedICP.h>
#include <open3d/pipelines/registration/Registration.h>
#include <open3d/pipelines/registration/TransformationEstimation.h>

namespace kilter {
namespace {

namespace o3d = open3d::pipelines::registration;

constexpr double kReach_m = 1.0;
constexpr int kNeighbours = 20;

open3d::geometry::PointCloud cloud_of(const VoxelMap& map) {
  open3d::geometry::PointCloud cloud;
  cloud.points_.reserve(map.voxels().size());
  for (const Eigen::Vector3f& at_m : map.voxels().centroids_m) cloud.points_.push_back(at_m.cast<double>());
  cloud.EstimateNormals(open3d::geometry::KDTreeSearchParamKNN(kNeighbours));
  return cloud;
}

// It knows no failure but an empty set of correspondences.
std::optional<Pose3> pose_of(const o3d::RegistrationResult& result) {
  if (result.correspondence_set_.empty()) return std::nullopt;
  const Eigen::Matrix3d R = result.transformation_.topLeftCorner<3, 3>();
  return Pose3(Eigen::Quaterniond(R), result.transformation_.topRightCorner<3, 1>());
}

o3d::ICPConvergenceCriteria criteria() { return {1e-6, 1e-6, 50}; }

}  // namespace

std::optional<Pose3> align_by_open3d_plane(const VoxelMap& source, const VoxelMap& target, const Pose3& start) {
  return pose_of(o3d::RegistrationICP(cloud_of(source), cloud_of(target), kReach_m, start.isometry().matrix(),
                                      o3d::TransformationEstimationPointToPlane(), criteria()));
}

std::optional<Pose3> align_by_open3d_gicp(const VoxelMap& source, const VoxelMap& target, const Pose3& start) {
  return pose_of(o3d::RegistrationGeneralizedICP(cloud_of(source), cloud_of(target), kReach_m,
                                                 start.isometry().matrix(),
                                                 o3d::TransformationEstimationForGeneralizedICP(), criteria()));
}

}  // namespace kilter
