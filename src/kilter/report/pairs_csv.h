// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "kilter/pipeline/result.h"

namespace kilter {

/// One row per listed pair with what result.json holds of it in single values, under the same names; absent is an empty
/// cell. `offset_low_m`, `offset_high_m` and `offset_x`, `offset_y`, `offset_z` take the place of the lists;
/// `unobservable` counts directions; each evidence NAME of any pair gives `evidence_NAME` (the measured value) and
/// `evidence_NAME_log_ratio`. Poses, covariances and histograms are in result.json only.
[[nodiscard]] std::string pairs_csv(const Result& result);

}  // namespace kilter
