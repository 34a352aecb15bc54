// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/consistency/consistency_matrix.h"

namespace kilter {

InconsistencyMatrix verified(const ConsistencyMatrix& theta, const ConsistencyMatrix& gamma) {
  KILTER_EXPECTS(theta.size() == gamma.size());
  InconsistencyMatrix difference(gamma.size());
  for (const auto& [pair, before] : gamma.entries()) {
    const std::optional<double> after = theta.get(pair);
    if (after) difference.set(pair, *after - before);  // Algorithm 1, last line
  }
  return difference;
}

}  // namespace kilter
