// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kilter/pipeline/result.h"

namespace kilter {

/// What pairs with the same trouble have in common: a short name for what a reason of judge_pair or
/// judge_pair_by_gamma says, at most 70 columns and without what was measured. A reason that it does not know comes
/// back without its offset, without what stands after a semicolon, and with dots for numbers.
[[nodiscard]] std::string cause_of(std::string_view reason);

/// Causes of a result's unverified pairs and how many have each, the commonest first, then by name.
[[nodiscard]] std::vector<std::pair<std::string, std::size_t>> unverified_causes(const Result& result);

}  // namespace kilter
