// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/same_side.h"

#include <cmath>

namespace kilter {
namespace {

constexpr double kLeastAgreement = 0.6;  // cosine between normals of one surface

std::size_t count_one_way(const SurfaceVoxels& from, NearestVoxelCursor& onto, const Pose3& T_onto_from,
                          double max_distance_m, bool oriented) {
  const SurfaceVoxels& others = onto.map().voxels();
  const Eigen::Isometry3d T = T_onto_from.isometry();
  std::size_t count = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const auto near = onto.nearest(T * from.centroids_m[i].cast<double>(), max_distance_m);
    if (!near) continue;
    const Eigen::Vector3d normal = T.linear() * from.normals[i].cast<double>();
    if (normals_agree(normal, others.normals[near->voxel].cast<double>(), oriented)) ++count;
  }
  return count;
}

}  // namespace

bool normals_agree(const Eigen::Vector3d& a, const Eigen::Vector3d& b, bool oriented) {
  if (a.isZero() || b.isZero()) return true;
  const double cosine = a.dot(b);
  return (oriented ? cosine : std::abs(cosine)) >= kLeastAgreement;
}

SameSide count_same_side(NearestVoxelCursor& source, NearestVoxelCursor& target, const Pose3& T_target_source,
                         double max_distance_m) {
  const bool oriented = source.map().has_free_space() && target.map().has_free_space();
  return {count_one_way(source.map().voxels(), target, T_target_source, max_distance_m, oriented),
          count_one_way(target.map().voxels(), source, T_target_source.inverse(), max_distance_m, oriented)};
}

}  // namespace kilter
