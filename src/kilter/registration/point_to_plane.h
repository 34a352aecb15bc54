// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kilter/registration/registration.h"

namespace kilter {

/// Gauss-Newton on r = n_t . (T p_s - c_t), and the same with the roles exchanged (so that swapping source and target
/// inverts the result), with a Geman-McClure kernel whose scale follows the residuals, search
/// distance shrinking from search_distance_m to a few voxels, normals required to agree. Directions with too little
/// information are left at the start ("solution remapping"). \sa align_submaps.
[[nodiscard]] RegistrationResult align_point_to_plane(const NearestVoxelSearch& source,
                                                      const NearestVoxelSearch& target,
                                                      const Pose3& T_target_source_start,
                                                      const RegistrationOptions& options,
                                                      const RegistrationPrior& prior);

/// The second stage, for errors beyond the basin of the first: coarse_search over options.wide_translation_m, or
/// the prior's translation if that is more, but a metre up and down at most, and max_rotation_rad; a descent from the
/// start and from each coarse pose that scores at least 0.6 of the best; and the one of most worth refined. Says in
/// `ambiguity` how well the next best, distinct pose fits. About ten times the cost of the first.
[[nodiscard]] RegistrationResult align_widely(const NearestVoxelSearch& source, const NearestVoxelSearch& target,
                                              const Pose3& T_target_source_start, const RegistrationOptions& options,
                                              const RegistrationPrior& prior);

/// Descends from a guess instead of from the map's pose, at most a metre from it. `ambiguity` is left absent.
[[nodiscard]] RegistrationResult align_near(const NearestVoxelSearch& source, const NearestVoxelSearch& target,
                                            const Pose3& T_target_source_start, const Pose3& T_target_source_guess,
                                            const RegistrationOptions& options, const RegistrationPrior& prior);

}  // namespace kilter
