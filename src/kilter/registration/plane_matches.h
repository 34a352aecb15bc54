// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "kilter/matching/nearest_voxel.h"
#include "kilter/matching/pair_grain.h"
#include "kilter/registration/normal_equations.h"

namespace kilter {

/// Two submaps under many poses: what one look found out serves the next.
struct PlanePair {
  const NearestVoxelSearch& source;
  const NearestVoxelSearch& target;
  RepeatedSearch in_source{source, target.map().voxels().size()};
  RepeatedSearch in_target{target, source.map().voxels().size()};
  PairGrain grain = grain_of(source.map(), target.map());

  [[nodiscard]] const VoxelMap& source_map() const { return source.map(); }
  [[nodiscard]] const VoxelMap& target_map() const { return target.map(); }
};

inline constexpr std::size_t kAllPoints = 1U << 31;

/// A point this near the plane of an agreeing voxel fits. [voxels]
inline constexpr double kPlaneSupportVoxels = 0.25;

/// The same in metres, for voxels or for cells: what their cells explain fits, or poses that lay one lattice on the
/// other would seem the better ones.
[[nodiscard]] inline double support_m(const PairGrain& grain) {
  return kPlaneSupportVoxels * grain.edge_m + grain.most_m;
}

/// How far a place moves on top of a pose, in the frame that is matched onto, if one submap saw it at `from_at` and the
/// other at `onto_at` (SurfaceVoxels::seen_at).
using MotionOfPlace =
    std::function<Eigen::Vector3d(const Eigen::Vector3d& at_m, std::uint8_t from_at, std::uint8_t onto_at)>;

/// Centroids of these voxels of `from` against the planes of `onto` near them, at most `search_m` away, whose normals
/// agree; appended, in the frame of `onto`. Weights are the planes' planarity. With a `shift`, each looks near where
/// that puts it, given when what it meets without was seen; residuals are without it all the same.
void match_voxels(const VoxelMap& from, std::span<const std::uint32_t> voxels, RepeatedSearch& in_onto,
                  const Pose3& T_onto_from, double search_m, std::vector<PlaneResidual>& residuals,
                  const MotionOfPlace& shift = {});

/// Centroids of about `max_points` voxels of each submap against the planes through the other's near them (the nearest,
/// or what RepeatedSearch takes for it), at most `search_m` away, normals within 53 degrees; both ways, so that it does
/// not matter which of the two is called the source. Weights are the planes' planarity. Target frame. A `shift` moves
/// the source's places on top of the pose, `from_at` being when the source saw them.
[[nodiscard]] std::vector<PlaneResidual> match_planes(PlanePair& pair, const Pose3& T_target_source, double search_m,
                                                      std::size_t max_points, const MotionOfPlace& shift = {});

/// The same in place of what `residuals` held, whose memory serves again. \return how many voxels they stand for, of
/// both submaps, since of a large one only some are asked.
std::size_t match_planes(PlanePair& pair, const Pose3& T_target_source, double search_m, std::size_t max_points,
                         std::vector<PlaneResidual>& residuals);

/// The same, of every `stride`-th voxel of both.
[[nodiscard]] std::vector<PlaneResidual> match_every(PlanePair& pair, const Pose3& T_target_source, double search_m,
                                                     std::size_t stride);

/// Geman-McClure weight, 0..1: residuals far beyond the scale stop pulling.
[[nodiscard]] inline double geman_mcclure(double residual_m, double scale_m) {
  const double ratio = scale_m * scale_m / (scale_m * scale_m + residual_m * residual_m);
  return ratio * ratio;
}

/// Robust weights on top of planarity, by a Geman-McClure kernel. The scale follows the residuals' own spread but never
/// falls below `least_m`: where floor and ceiling are most of the scene they fit whatever the walls say, and a scale
/// taken from them alone would cut the walls off before they could pull. Precondition: there are residuals.
void apply_kernel(std::vector<PlaneResidual>& residuals, double least_m);

}  // namespace kilter
