// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_types.h>

#include <cmath>

#include "methods.h"

namespace kilter {
namespace {

struct State {
  pcl::KdTreeFLANN<pcl::PointXYZ> tree;
  pcl::Indices index = pcl::Indices(1);
  std::vector<float> square_m2 = std::vector<float>(1);

  explicit State(const Side& side) {
    const pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
    for (const Eigen::Vector3f& point_m : side.points_m) cloud->emplace_back(point_m.x(), point_m.y(), point_m.z());
    tree.setInputCloud(cloud);
  }
};

// It has no bound for the nearest neighbour: what is beyond the limit is found, and left out.
float distance_of(State& state, const Eigen::Vector3f& at_m) {
  state.tree.nearestKSearch(pcl::PointXYZ(at_m.x(), at_m.y(), at_m.z()), 1, state.index, state.square_m2);
  const float distance_m = std::sqrt(state.square_m2[0]);
  return distance_m > static_cast<float>(kLimit_m) ? kNone : distance_m;
}

}  // namespace

Method by_pcl(const Side& source, const Side& target) {
  return point_by_point<State>("PCL KdTreeFLANN", source, target, distance_of);
}

}  // namespace kilter
