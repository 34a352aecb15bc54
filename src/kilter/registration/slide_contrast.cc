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
constexpr double kDeviations = 2.0;  // of a count, that chance may have added to it
constexpr double kMostScaled = 2.0;
constexpr std::size_t kMostPoints = 6000;  // of each submap
constexpr std::size_t kMostAlong = 1500;   // of each submap
constexpr double kAlong = 0.2;             // sine between a surface and a motion along it, at most

using Voxels = std::vector<std::uint32_t>;

// Voxels of one submap by what a motion does to their surfaces.
struct PointsToSlide {
  const VoxelMap& map;
  Voxels facing;
  Voxels along;  // which the motion shifts in themselves
};

void thin_out(Voxels& voxels, std::size_t most) {
  if (voxels.size() <= most) return;
  for (std::size_t k = 0; k < most; ++k) voxels[k] = voxels[k * voxels.size() / most];
  voxels.resize(most);
}

// \param T_target_points  where the submap lies; the motion is the target frame's
PointsToSlide points_to_slide(const VoxelMap& map, const Pose3& T_target_points, const Vector6& motion) {
  PointsToSlide points{map, {}, {}};
  const SurfaceVoxels& surface = map.voxels();
  const Eigen::Isometry3d T = T_target_points.isometry();
  const Eigen::Vector3d shift = motion.head<3>();
  const Eigen::Vector3d turn = motion.tail<3>();
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const Eigen::Vector3d moved = shift + turn.cross(T * surface.centroids_m[i].cast<double>());
    const Eigen::Vector3d normal = T.linear() * surface.normals[i].cast<double>();
    if (faces(normal, moved)) {
      points.facing.push_back(static_cast<std::uint32_t>(i));
    } else if (surface.planarity[i] > 0.0F && std::abs(normal.dot(moved)) < kAlong * moved.norm()) {
      points.along.push_back(static_cast<std::uint32_t>(i));
    }
  }
  thin_out(points.facing, kMostPoints);
  thin_out(points.along, kMostAlong);
  return points;
}

struct Fit {
  double fitting = 0.0;  // points that face the motion and fit
  double met = 0.0;      // surfaces along it with a plane near them that faces the same way
};

Fit fit_of(const PointsToSlide& points, RepeatedSearch& in_onto, const Pose3& T_onto_points, const PairGrain& grain) {
  const NearestVoxelSearch& onto = in_onto.search();
  const double search_m = std::min(kSearchVoxels * grain.edge_m, onto.max_distance_m());
  std::vector<PlaneResidual> met;
  match_voxels(points.map, points.facing, in_onto, T_onto_points, search_m, met);
  const auto fits = [&](const PlaneResidual& r) { return std::abs(r.residual_m) < support_m(grain); };
  const auto fitting = static_cast<double>(std::count_if(met.begin(), met.end(), fits));
  met.clear();
  match_voxels(points.map, points.along, in_onto, T_onto_points, search_m, met);
  return {fitting, static_cast<double>(met.size())};
}

}  // namespace

SlideContrast slide_contrast(PlanePair& pair, const Pose3& T_target_source, const Vector6& motion) {
  const PointsToSlide of_source = points_to_slide(pair.source_map(), T_target_source, motion);
  const PointsToSlide of_target = points_to_slide(pair.target_map(), Pose3(), motion);
  const auto fitting_after = [&](double slide_m) {
    const Pose3 T = Pose3::exp(slide_m * motion) * T_target_source;
    const Fit forward = fit_of(of_source, pair.in_target, T, pair.grain);
    const Fit backward = fit_of(of_target, pair.in_source, T.inverse(), pair.grain);
    return Fit{forward.fitting + backward.fitting, forward.met + backward.met};
  };
  const Fit here = fitting_after(0.0);
  SlideContrast found{0.0, kWidest};
  if (here.fitting < kFewestFitting) return found;
  const double surely_fitting = here.fitting - kDeviations * std::sqrt(here.fitting);
  double elsewhere = 1.0;
  for (const double slide : kSlides) {
    for (const double slide_m : {slide * pair.grain.edge_m, -slide * pair.grain.edge_m}) {
      const Fit slid = fitting_after(slide_m);
      elsewhere = std::max(elsewhere, slid.fitting * std::clamp(here.met / std::max(slid.met, 1.0), 1.0, kMostScaled));
    }
    const SlideContrast beyond{surely_fitting / elsewhere, slide};
    if (slide >= kWidest || beyond.fixed()) found = beyond;
    if (slide <= kWidest && !beyond.fixed()) break;
  }
  return found;
}

}  // namespace kilter
