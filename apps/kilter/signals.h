// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>

namespace kilter::app {

/// From now on the first SIGINT or SIGTERM only raises `stop_flag`; a second one ends the program at once.
void catch_stop_signals();

/// True once a stop was asked for; for RunContext::cancelled.
[[nodiscard]] const std::atomic<bool>& stop_flag();

/// Number of the signal that asked for it; 0 before.
[[nodiscard]] int caught_signal();

}  // namespace kilter::app
