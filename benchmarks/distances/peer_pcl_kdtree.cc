// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_types.h>

#include <cmath>
#include <memory>

#include "methods.h"

namespace kilter {
namespace {

using Tree = pcl::KdTreeFLANN<pcl::PointXYZ>;

std::unique_ptr<Tree> tree_of(const Side& side) {
  const pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  for (const Eigen::Vector3f& point_m : side.points_m) cloud->emplace_back(point_m.x(), point_m.y(), point_m.z());
  auto tree = std::make_unique<Tree>();
  tree->setInputCloud(cloud);
  return tree;
}

}  // namespace

// It has no bound for the nearest neighbour: what is beyond the limit is found, and left out.
Method by_pcl(const Side& source, const Side& target) {
  return {"PCL KdTreeFLANN", [&, tree = std::make_shared<std::unique_ptr<Tree>>()](
                                 std::span<const Pose3> poses, std::vector<float>& distances_m, bool build) {
            if (build || !*tree) *tree = tree_of(target);
            pcl::Indices index(1);
            std::vector<float> square_m2(1);
            for (const Pose3& pose : poses) {
              const Eigen::Isometry3d T = pose.isometry();
              for (std::size_t i = 0; i < source.points_m.size(); ++i) {
                const Eigen::Vector3f at_m = moved(T, source.points_m[i]).cast<float>();
                (*tree)->nearestKSearch(pcl::PointXYZ(at_m.x(), at_m.y(), at_m.z()), 1, index, square_m2);
                const float distance_m = std::sqrt(square_m2[0]);
                distances_m[i] = distance_m > static_cast<float>(kLimit_m) ? kNone : distance_m;
              }
            }
          }};
}

}  // namespace kilter
