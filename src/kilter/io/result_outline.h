// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "kilter/base/expected.h"

namespace kilter {

/// How much a result.json tells of.
struct ResultOutline {
  std::size_t robots = 0;
  std::size_t submaps = 0;
  std::size_t pairs = 0;
};

/// Walks through a result's text without building it.
/// \return  kParse (not JSON, not an object, a key is missing or no list), kUnsupported (another schema).
[[nodiscard]] Expected<ResultOutline> read_result_outline(std::string_view text, const std::string& where);

}  // namespace kilter
