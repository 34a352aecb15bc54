// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/exit_status.h"

#include "apps/kilter/signals.h"

namespace kilter::app {

int exit_status(ErrorCode code) {
  switch (code) {
    case ErrorCode::kUsage:
    case ErrorCode::kConfig:
    case ErrorCode::kInvalidArgument:
      return kExitUsage;
    case ErrorCode::kNotFound:
    case ErrorCode::kIo:
    case ErrorCode::kParse:
    case ErrorCode::kTruncated:
    case ErrorCode::kCountMismatch:
    case ErrorCode::kInvalidPose:
    case ErrorCode::kInvalidPoints:
    case ErrorCode::kUnsupported:
    case ErrorCode::kEmptyInput:
    case ErrorCode::kMissingDependency:
      return kExitInput;
    case ErrorCode::kCancelled:
      return 128 + caught_signal();
    case ErrorCode::kOutOfMemory:
    case ErrorCode::kNoSpace:
    case ErrorCode::kInternal:
      return kExitResources;
  }
  return kExitResources;
}

int exit_status_of_output(ErrorCode code) {
  return code == ErrorCode::kCancelled ? exit_status(code) : static_cast<int>(kExitResources);
}

int exit_status(MapState state, FailOn fail_on) {
  if (state == MapState::kInconsistent && fail_on != FailOn::kNever) return kExitInconsistent;
  if (state == MapState::kUndetermined && fail_on == FailOn::kUndetermined) return kExitUndetermined;
  return kExitGood;
}

}  // namespace kilter::app
