// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>

#include "kilter/base/expected.h"

namespace kilter::app {

/// From now on the first SIGINT, SIGTERM or SIGHUP only raises `stop_flag`; a second one of the first two ends the
/// program at once. Signals that were ignored when the program began stay so.
void catch_stop_signals();

/// True once a stop was asked for; for RunContext::cancelled.
[[nodiscard]] const std::atomic<bool>& stop_flag();

/// Number of the signal that asked for it; 0 before.
[[nodiscard]] int caught_signal();

/// What a run ends with that was stopped before anything got its final name.
[[nodiscard]] Error stopped();

}  // namespace kilter::app
