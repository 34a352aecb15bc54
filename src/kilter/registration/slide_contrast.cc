// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/registration/slide_contrast.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace kilter {
namespace {

constexpr std::array kSlides = {10.0, 7.5, 5.0, 3.0, 2.0};  // voxels
constexpr double kWidest = 5.0;                             // of these, that a peak may be
constexpr double kSearchVoxels = 4.0;
constexpr double kFewestFitting = 20.0;
constexpr double kMostScaled = 2.0;
constexpr std::size_t kMostPoints = 6000;  // of each submap

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
    const Eigen::Vector3d normal = T.linear() * surface.normals[i].cast<double>();
    if (faces(normal, moved)) facing.voxels.push_back(static_cast<std::uint32_t>(i));
  }
  if (facing.voxels.size() > kMostPoints) {
    for (std::size_t k = 0; k < kMostPoints; ++k) {
      facing.voxels[k] = facing.voxels[k * facing.voxels.size() / kMostPoints];
    }
    facing.voxels.resize(kMostPoints);
  }
  return facing;
}

struct Fit {
  double fitting = 0.0;
  double met = 0.0;  // points with a plane near them that faces the same way
};

Fit fit_of(const FacingPoints& points, RepeatedSearch& in_onto, const Pose3& T_onto_points, const PairGrain& grain) {
  const NearestVoxelSearch& onto = in_onto.search();
  const double search_m = std::min(kSearchVoxels * grain.edge_m, onto.max_distance_m());
  std::vector<PlaneResidual> met;
  match_voxels(points.map, points.voxels, in_onto, T_onto_points, search_m, met);
  const auto fits = [&](const PlaneResidual& r) { return std::abs(r.residual_m) < support_m(grain); };
  return {static_cast<double>(std::count_if(met.begin(), met.end(), fits)), static_cast<double>(met.size())};
}

}  // namespace

SlideContrast slide_contrast(PlanePair& pair, const Pose3& T_target_source, const Vector6& motion) {
  const FacingPoints of_source = facing_points(pair.source_map(), T_target_source, motion);
  const FacingPoints of_target = facing_points(pair.target_map(), Pose3(), motion);
  const auto fitting_after = [&](double slide_m) {
    Vector6 turn = Vector6::Zero();
    turn.tail<3>() = slide_m * motion.tail<3>();
    const Pose3 T = Pose3(Pose3::exp(turn).rotation(), slide_m * motion.head<3>()) * T_target_source;
    const Fit forward = fit_of(of_source, pair.in_target, T, pair.grain);
    const Fit backward = fit_of(of_target, pair.in_source, T.inverse(), pair.grain);
    return Fit{forward.fitting + backward.fitting, forward.met + backward.met};
  };
  const Fit here = fitting_after(0.0);
  SlideContrast found{0.0, kWidest};
  if (here.fitting < kFewestFitting) return found;
  double elsewhere = 1.0;
  for (const double slide : kSlides) {
    for (const double slide_m : {slide * pair.grain.edge_m, -slide * pair.grain.edge_m}) {
      const Fit slid = fitting_after(slide_m);
      elsewhere = std::max(elsewhere, slid.fitting * std::clamp(here.met / std::max(slid.met, 1.0), 1.0, kMostScaled));
    }
    const SlideContrast beyond{here.fitting / elsewhere, slide};
    if (slide >= kWidest || beyond.fixed()) found = beyond;
    if (slide <= kWidest && !beyond.fixed()) break;
  }
  return found;
}

}  // namespace kilter
