// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kilter/registration/plane_matches.h"

namespace kilter {

/// How much better the pose fits than poses slid along one direction.
struct SlideContrast {
  /// Points that fit at the pose, less two standard deviations of their count / the most that fit after any longer
  /// slide, were as much of the overlap left there.
  double contrast = 0.0;
  double beyond_voxels = 0.0;  ///< slides of at least this

  /// Enough for the direction to be fixed.
  [[nodiscard]] bool fixed() const { return contrast >= kLeast; }
  /// Standard deviation along the direction that comes from what fits anywhere. [voxels] Precondition: fixed(). Chosen
  /// by errors where the truth is known, alike in car parks and tunnels.
  [[nodiscard]] double blur_voxels() const { return 0.07 * beyond_voxels / (contrast - 1.0); }

  static constexpr double kLeast = 1.5;
};

/// Whether a weakly fixed direction is fixed at all: slides the source along it, matches anew each time and counts the
/// points that fit (lie within a quarter voxel of an agreeing plane), of those whose own normal lies within 66 degrees
/// of the way that they would go.
///
/// Surfaces that face the motion fit at one place; where a submap is bent, near it. What else seems to face it, edges
/// and scattered normals of the surfaces along it, fits wherever it is put: the linearised information counts it all
/// the same. So the contrast is told beyond the shortest slide, of 2, 3 or 5 voxels, from which on it is enough, up to
/// 10; beyond 5 if it never is. Zero where fewer than 20 points fit.
///
/// A slide may leave the overlap, so that less fits. How much is left is told by surfaces along the motion, which go on
/// meeting their like as far as the overlap reaches (up to twice is made up for); those that face it meet nothing any
/// more once they have left their place, and would say that everything was gone.
///
/// \param motion  v0 + w x p of the target frame, of RMS 1 m over what is matched
/// O(facing points).
[[nodiscard]] SlideContrast slide_contrast(PlanePair& pair, const Pose3& T_target_source, const Vector6& motion);

}  // namespace kilter
