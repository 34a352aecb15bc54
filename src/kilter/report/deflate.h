// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace kilter {

/// Bytes packed in the zlib format (RFC 1950), as PNG and browsers read it.
[[nodiscard]] std::string deflated(std::string_view bytes);

}  // namespace kilter
