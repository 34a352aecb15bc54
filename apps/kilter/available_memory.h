// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>

namespace kilter::app {

/// Memory that this process may still take without pushing others out: what the system has available, or what its
/// control group leaves if that is less, as in containers. Absent where neither tells. [bytes]
[[nodiscard]] std::optional<std::size_t> available_memory();

/// What --memory asks for, or half of what is available where it asks for nothing (0). 0 = no limit. [bytes]
[[nodiscard]] std::size_t memory_budget(std::size_t asked_bytes);

}  // namespace kilter::app
