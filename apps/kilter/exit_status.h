// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kilter/base/expected.h"
#include "kilter/verification/verdict.h"

namespace kilter::app {

/// Exit statuses of the program; a promise. After a signal it is 128 + the signal's number.
enum ExitStatus : int {
  kExitGood = 0,          ///< `check`: consistent
  kExitInconsistent = 1,  ///< `check` only
  kExitUsage = 2,         ///< command line or configuration
  kExitInput = 3,         ///< the input cannot be used
  kExitUndetermined = 4,  ///< `check` only
  kExitResources = 5,     ///< memory, disk, output, or a defect of ours
};

/// Which map states end `check` with a status of failure. (`--fail-on`)
enum class FailOn {
  kInconsistent,  ///< an undetermined map passes
  kUndetermined,  ///< an inconsistent map fails, and an undetermined one too; the default
  kNever,
};

/// Status of an error in the command line or the input. A cancelled run ends with the signal that stopped it.
[[nodiscard]] int exit_status(ErrorCode code);

/// Status of an error while writing: whatever refused, it was not the input.
[[nodiscard]] int exit_status_of_output(ErrorCode code);

[[nodiscard]] int exit_status(MapState state, FailOn fail_on);

}  // namespace kilter::app
