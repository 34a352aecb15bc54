// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>

namespace kilter {

/// Everything that can go wrong outside the program's own logic. Each has a stable name and an explanation
/// (error_catalog.h); the apps map them to exit statuses.
enum class ErrorCode {
  kUsage,              ///< the command line asks for something that does not exist
  kConfig,             ///< a key, value or unit in configuration is not valid
  kNotFound,           ///< a named file or folder does not exist
  kIo,                 ///< the operating system refused to read or write
  kParse,              ///< text or header does not follow its format
  kTruncated,          ///< a file ends before what its header promises
  kCountMismatch,      ///< poses and scans (or two declared counts) differ
  kInvalidPose,        ///< non-finite pose, non-unit quaternion or non-rigid rotation
  kInvalidPoints,      ///< a cloud holds no usable point
  kUnsupported,        ///< a known format or variant that kilter does not read
  kEmptyInput,         ///< nothing to work on: no robot, no scan
  kMissingDependency,  ///< an optional part was not built in
  kInvalidArgument,    ///< a value handed to the library lies outside its domain
  kOutOfMemory,        ///< the memory budget or the machine's memory is used up
  kNoSpace,            ///< the disk is full
  kCancelled,          ///< stopped on request
  kInternal,           ///< a defect of kilter itself
};

/// What went wrong, told so that the message alone is enough.
struct Error {
  ErrorCode code = ErrorCode::kInternal;
  std::string message;  ///< what was expected and what was found
  std::string where;    ///< file, and line or byte offset if there is one; may be empty
  std::string hint;     ///< what to do about it; may be empty
};

template <typename T>
using Expected = tl::expected<T, Error>;

/// Shorthand for returning a failure: `return fail(ErrorCode::kParse, "expected 8 columns, found 7", where);`
[[nodiscard]] inline tl::unexpected<Error> fail(ErrorCode code, std::string message, std::string where = {},
                                                std::string hint = {}) {
  return tl::unexpected<Error>(Error{code, std::move(message), std::move(where), std::move(hint)});
}

/// Hands an error of another Expected upwards unchanged.
[[nodiscard]] inline tl::unexpected<Error> pass_up(Error error) { return tl::unexpected<Error>(std::move(error)); }

/// "parse: poses.tum:12: expected 8 columns, found 7\n  try: ..." (the code's stable name first).
[[nodiscard]] std::string to_string(const Error& error);

/// Stable name of a code as printed and taken by `kilter explain`, e.g. "count-mismatch".
[[nodiscard]] std::string_view error_code_name(ErrorCode code);

/// Text from files made safe to print: control bytes and invalid UTF-8 become '?', cut after `max_bytes`.
[[nodiscard]] std::string printable(std::string_view text, std::size_t max_bytes = 200);

}  // namespace kilter
