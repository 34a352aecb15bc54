// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/slide_contrast.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace kilter {
namespace {

constexpr double kFacingCosine = 0.4;
constexpr std::array kSlides = {2.0, 3.0, 5.0, 7.5, 10.0};  // voxels
constexpr double kSearchVoxels = 4.0;
constexpr double kFitVoxels = 0.25;
constexpr std::size_t kFewestFitting = 20;
constexpr std::size_t kMostPoints = 6000;  // of each submap
constexpr double kBlurVoxels = 0.14;

// Voxels of one submap that face a motion.
struct FacingPoints {
  const VoxelMap& map;
  std::vector<std::uint32_t> voxels;
};

// \param T_target_points  where the submap lies; the motion is the target frame's
FacingPoints facing_points(const VoxelMap& map, const Pose3& T_target_points, const Vector6& motion) {
  FacingPoints facing{map, {}};
  const SurfaceVoxels& surface = map.voxels();
  const Eigen::Isometry3d T = T_target_points.isometry();
  const Eigen::Vector3d shift = motion.head<3>();
  const Eigen::Vector3d turn = motion.tail<3>();
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const Eigen::Vector3d moved = shift + turn.cross(T * surface.centroids_m[i].cast<double>());
    const double along = (T.linear() * surface.normals[i].cast<double>()).dot(moved);
    if (std::abs(along) > kFacingCosine * moved.norm()) facing.voxels.push_back(static_cast<std::uint32_t>(i));
  }
  if (facing.voxels.size() > kMostPoints) {
    for (std::size_t k = 0; k < kMostPoints; ++k) {
      facing.voxels[k] = facing.voxels[k * facing.voxels.size() / kMostPoints];
    }
    facing.voxels.resize(kMostPoints);
  }
  return facing;
}

std::size_t count_fitting(const FacingPoints& points, const VoxelMap& onto, NearestVoxelCursor& in_onto,
                          const Pose3& T_onto_points) {
  const double resolution_m = onto.resolution_m();
  const SurfaceVoxels& planes = onto.voxels();
  const bool oriented = points.map.has_free_space() && onto.has_free_space();
  const Eigen::Isometry3d T = T_onto_points.isometry();
  std::size_t fitting = 0;
  for (const std::uint32_t i : points.voxels) {
    const Eigen::Vector3d point_m = T * points.map.voxels().centroids_m[i].cast<double>();
    const auto nearest = in_onto.nearest(point_m, kSearchVoxels * resolution_m);
    if (!nearest) continue;
    const Eigen::Vector3d normal = planes.normals[nearest->voxel].cast<double>();
    if (normal.isZero()) continue;
    if (!normals_agree(T.linear() * points.map.voxels().normals[i].cast<double>(), normal, oriented)) continue;
    const double residual_m = normal.dot(point_m - planes.centroids_m[nearest->voxel].cast<double>());
    fitting += std::abs(residual_m) < kFitVoxels * resolution_m ? 1 : 0;
  }
  return fitting;
}

}  // namespace

double slide_contrast(PlanePair& pair, const Pose3& T_target_source, const Vector6& motion) {
  const FacingPoints of_source = facing_points(pair.source_map(), T_target_source, motion);
  const FacingPoints of_target = facing_points(pair.target_map(), Pose3(), motion);
  const auto fitting_after = [&](double slide_m) {
    Vector6 turn = Vector6::Zero();
    turn.tail<3>() = slide_m * motion.tail<3>();
    const Pose3 T = Pose3(Pose3::exp(turn).rotation(), slide_m * motion.head<3>()) * T_target_source;
    return count_fitting(of_source, pair.target_map(), pair.in_target, T) +
           count_fitting(of_target, pair.source_map(), pair.in_source, T.inverse());
  };
  const std::size_t here = fitting_after(0.0);
  if (here < kFewestFitting) return 0.0;
  std::size_t elsewhere = 1;
  for (const double slide : kSlides) {
    const double slide_m = slide * pair.target_map().resolution_m();
    elsewhere = std::max({elsewhere, fitting_after(slide_m), fitting_after(-slide_m)});
  }
  return static_cast<double>(here) / static_cast<double>(elsewhere);
}

double blur_voxels(double contrast) { return kBlurVoxels / (contrast - 1.0); }

}  // namespace kilter
