// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/occupancy/surface_normals.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace kilter {
namespace {

constexpr int kNearRadius = 2;
constexpr int kFarRadius = 4;
constexpr int kEnoughNeighbours = 8;
constexpr int kFewestNeighbours = 5;
// Below this ratio of the middle to the largest spread the support is a line: its normal is arbitrary.
constexpr double kLineRatio = 0.05;

struct Scatter {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  int count = 0;

  void add(const Eigen::Vector3d& offset) {
    sum += offset;
    squares.noalias() += offset * offset.transpose();
    ++count;
  }

  [[nodiscard]] Eigen::Matrix3d covariance() const {
    const Eigen::Vector3d mean = sum / count;
    return squares / count - mean * mean.transpose();
  }
};

Scatter scatter_around(const VoxelMap& map, std::size_t i, int radius) {
  const Eigen::Vector3d origin = map.voxels().centroids_m[i].cast<double>();
  Scatter scatter;
  map.visit_window(map.indices()[i], radius, [&](std::uint32_t neighbour) {
    scatter.add(map.voxels().centroids_m[neighbour].cast<double>() - origin);
  });
  return scatter;
}

}  // namespace

VoxelMap with_surface_normals(const VoxelMap& map) {
  SurfaceVoxels voxels = map.voxels();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const Eigen::Vector3d view = voxels.normals[i].cast<double>();
    voxels.normals[i].setZero();
    voxels.planarity[i] = 0.0F;
    Scatter scatter = scatter_around(map, i, kNearRadius);
    if (scatter.count < kEnoughNeighbours) scatter = scatter_around(map, i, kFarRadius);
    if (scatter.count < kFewestNeighbours) continue;
    solver.computeDirect(scatter.covariance());
    const Eigen::Vector3d spread = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
    if (!(spread[2] > 0.0) || spread[1] < kLineRatio * spread[2]) continue;
    Eigen::Vector3d normal = solver.eigenvectors().col(0).normalized();
    if (normal.dot(view) < 0.0) normal = -normal;
    voxels.normals[i] = normal.cast<float>();
    voxels.planarity[i] = static_cast<float>((spread[1] - spread[0]) / spread[2]);
  }
  return {map.resolution_m(), map.has_free_space(), {map.blocks().begin(), map.blocks().end()}, std::move(voxels)};
}

}  // namespace kilter
