// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kilter/registration/plane_matches.h"

namespace kilter {

/// Whether a weakly fixed direction is fixed at all: slides the source along it, matches anew each time and counts the
/// points that fit, of those whose own normal lies within 66 degrees of the way that they would go.
///
/// Surfaces that face the motion fit at one place. What else seems to face it, edges and scattered normals of the
/// surfaces along it, fits wherever it is put: the linearised information counts it all the same.
///
/// \param motion  v0 + w x p of the target frame, of RMS 1 m over what is matched
/// \return points that fit (lie within a quarter voxel of an agreeing plane) at the pose / the most that fit after a
///         slide of 2 to 10 voxels either way; 0 where fewer than 20 fit. O(facing points).
[[nodiscard]] double slide_contrast(PlanePair& pair, const Pose3& T_target_source, const Vector6& motion);

/// A direction of less contrast is not fixed.
inline constexpr double kLeastContrast = 1.5;

/// Standard deviation along a direction of this contrast (> 1) that comes from what fits anywhere. [voxels] Seen where
/// the truth is known: 4.5 cm at a contrast of 1.3, 2.4 at 1.6, 1.0 at 2.2, 0.6 at 3.5, on voxels of 0.1 m, alike in
/// car parks and tunnels.
[[nodiscard]] double blur_voxels(double contrast);

}  // namespace kilter
