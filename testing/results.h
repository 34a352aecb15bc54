// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "kilter/pipeline/result.h"

namespace kilter::testing {

/// A robot of a hand-made result.
struct RobotOf {
  std::string name;
  int submaps = 1;
};

/// Robots and submaps in global numbering, ten scans and 10 m each, no pairs, undetermined.
[[nodiscard]] Result result_of(const std::vector<RobotOf>& robots);

/// Appends a pair with everything measured: offset 2 cm, consistent; kind by the submaps' robots.
PairResult& add_measured_pair(Result& result, int source, int target);

/// Appends a pair of which nothing could be measured: unverified, all that may be absent is.
PairResult& add_empty_pair(Result& result, int source, int target);

/// Robots a (2 submaps) and b (1): a sequential pair that is consistent, a global one that is inconsistent by 0.43 m,
/// and one of which nothing is known. The map is inconsistent.
[[nodiscard]] Result small_result();

}  // namespace kilter::testing
