// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kilter/registration/descent.h"

namespace kilter {

/// Judges where a descent ended, on all voxels: takes back what nothing fixes, follows the bend, and says how far the
/// pose is to be believed. What is not fixed is left where `start` has it.
[[nodiscard]] RegistrationResult settled_result(PlanePair& pair, const Pose3& start, Descent descent,
                                                const RegistrationOptions& options, const RegistrationPrior& prior);

}  // namespace kilter
