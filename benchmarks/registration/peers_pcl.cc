// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "benchmarks/registration/peers_pcl.h"

#include <pcl/features/normal_3d.h>
#include <pcl/registration/gicp.h>
#include <pcl/registration/icp.h>
#include <pcl/registration/ndt.h>

namespace kilter {
namespace {

constexpr double kReach_m = 1.0;
constexpr int kIterations = 50;
constexpr int kNeighbours = 20;

template <typename Point>
typename pcl::PointCloud<Point>::Ptr cloud_of(const VoxelMap& map) {
  auto cloud = pcl::make_shared<pcl::PointCloud<Point>>();
  cloud->reserve(map.voxels().size());
  for (const Eigen::Vector3f& at_m : map.voxels().centroids_m) {
    Point point;
    point.getVector3fMap() = at_m;
    cloud->push_back(point);
  }
  return cloud;
}

pcl::PointCloud<pcl::PointNormal>::Ptr with_normals(const VoxelMap& map) {
  auto cloud = cloud_of<pcl::PointNormal>(map);
  pcl::NormalEstimation<pcl::PointNormal, pcl::PointNormal> estimation;
  estimation.setInputCloud(cloud);
  estimation.setKSearch(kNeighbours);
  pcl::PointCloud<pcl::PointNormal> normals;
  estimation.compute(normals);
  for (std::size_t i = 0; i < cloud->size(); ++i)
    (*cloud)[i].getNormalVector3fMap() = normals[i].getNormalVector3fMap();
  return cloud;
}

template <typename Registration, typename Cloud>
std::optional<Pose3> run(Registration& registration, const Cloud& source, const Cloud& target, const Pose3& start) {
  registration.setInputSource(source);
  registration.setInputTarget(target);
  registration.setMaxCorrespondenceDistance(kReach_m);
  registration.setMaximumIterations(kIterations);
  typename Cloud::element_type aligned;
  registration.align(aligned, start.isometry().matrix().template cast<float>());
  if (!registration.hasConverged()) return std::nullopt;
  const Eigen::Matrix4d T = registration.getFinalTransformation().template cast<double>();
  return Pose3(Eigen::Quaterniond(Eigen::Matrix3d(T.topLeftCorner<3, 3>())), T.topRightCorner<3, 1>());
}

}  // namespace

std::optional<Pose3> align_by_pcl_icp(const VoxelMap& source, const VoxelMap& target, const Pose3& start) {
  pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> icp;
  return run(icp, cloud_of<pcl::PointXYZ>(source), cloud_of<pcl::PointXYZ>(target), start);
}

std::optional<Pose3> align_by_pcl_plane(const VoxelMap& source, const VoxelMap& target, const Pose3& start) {
  pcl::IterativeClosestPointWithNormals<pcl::PointNormal, pcl::PointNormal> icp;
  return run(icp, with_normals(source), with_normals(target), start);
}

std::optional<Pose3> align_by_pcl_gicp(const VoxelMap& source, const VoxelMap& target, const Pose3& start) {
  pcl::GeneralizedIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> gicp;
  return run(gicp, cloud_of<pcl::PointXYZ>(source), cloud_of<pcl::PointXYZ>(target), start);
}

std::optional<Pose3> align_by_pcl_ndt(const VoxelMap& source, const VoxelMap& target, const Pose3& start) {
  pcl::NormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ> ndt;
  ndt.setResolution(1.0F);
  return run(ndt, cloud_of<pcl::PointXYZ>(source), cloud_of<pcl::PointXYZ>(target), start);
}

}  // namespace kilter
