// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace kilter_testing {

/// The largest block that this thread asked `operator new` for since this was last set to 0; free to set. A test
/// program that links allocation_watch.cc counts; it replaces the global operators.
std::size_t& largest_allocation();

/// How many blocks this thread may still ask `operator new` for before it is refused all; free to set, endless at
/// first.
std::size_t& allocations_left();

}  // namespace kilter_testing
