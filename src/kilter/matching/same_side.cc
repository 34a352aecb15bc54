// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/same_side.h"

#include <cmath>

namespace kilter {
namespace {

std::size_t count_one_way(const SurfaceVoxels& from, const SurfaceVoxels& onto, const Pose3& T_onto_from,
                          const std::vector<NearestVoxel>& near, bool oriented) {
  const Eigen::Matrix3d R = T_onto_from.isometry().linear();
  std::size_t count = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (near[i].voxel == kNoVoxel) continue;
    const Eigen::Vector3d normal = R * from.normals[i].cast<double>();
    if (normals_agree(normal, onto.normals[near[i].voxel].cast<double>(), oriented)) ++count;
  }
  return count;
}

}  // namespace

bool normals_agree(const Eigen::Vector3d& a, const Eigen::Vector3d& b, bool oriented) {
  if (a.isZero() || b.isZero()) return true;
  const double cosine = a.dot(b);
  return (oriented ? cosine : std::abs(cosine)) >= kLeastAgreement;
}

SameSide count_same_side(const VoxelMap& source, const VoxelMap& target, const Pose3& T_target_source,
                         const NearestBothWays& near) {
  const bool oriented = source.has_free_space() && target.has_free_space();
  return {count_one_way(source.voxels(), target.voxels(), T_target_source, near.forward, oriented),
          count_one_way(target.voxels(), source.voxels(), T_target_source.inverse(), near.backward, oriented)};
}

}  // namespace kilter
