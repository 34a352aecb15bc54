// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string_view>

#include "kilter/base/expected.h"

namespace kilter {

/// One row of the list behind `kilter explain`.
struct CatalogEntry {
  ErrorCode code;
  std::string_view name;         ///< stable, printed in front of messages
  std::string_view explanation;  ///< what it means and what usually helps
};

/// All error codes, in the order of ErrorCode.
[[nodiscard]] std::span<const CatalogEntry> error_catalog();

}  // namespace kilter
