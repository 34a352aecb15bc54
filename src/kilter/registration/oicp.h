// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kilter/registration/registration.h"

namespace kilter {

/// Occupancy ICP: closest points within a distance that shrinks once a step has become short, pairs of very different
/// occupancy (> 0.4) and repeated targets dropped, the best kept (as many as the start's overlap is of the source),
/// weights p_s p_t / (1 + (d / 2r)^2), closed-form rigid fit. The seed's reference [4] gives the idea; these equations
/// are ours, since its own could not be obtained. Covariance as for point-to-plane, from its own residuals. \sa
/// align_submaps.
[[nodiscard]] RegistrationResult align_oicp(const NearestVoxelSearch& source, const NearestVoxelSearch& target,
                                            const Pose3& T_target_source_start, const RegistrationOptions& options,
                                            const RegistrationPrior& prior);

}  // namespace kilter
