// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>

#include "kilter/pipeline/result.h"

namespace kilter {

/// A matrix over all submaps of a result as CSV, N + 1 lines: header row and first column are submap ids, row = source,
/// column = target, the corner is empty. A cell that was not tested, failed or is infinite is empty.
///
/// \param cells  entries() of gamma_matrix, theta_matrix or verified_matrix of the same result. [1/m^3]
/// O(N^2).
[[nodiscard]] std::string matrix_csv(const Result& result, const std::map<PairId, double>& cells);

}  // namespace kilter
