// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>

namespace kilter::app {

/// Memory that this process may still take without pushing others out: what the system has available, or what its
/// control group leaves if that is less, as in containers; files that were read do not count, since they make room.
/// Absent where neither tells. [bytes]
/// \param root  where /proc and /sys are found.
[[nodiscard]] std::optional<std::size_t> available_memory(const std::filesystem::path& root = "/");

/// What --memory asks for; where it asks for nothing (0), half of what is available, but 256 MB at least; 0 = no limit,
/// where nothing tells what is available. [bytes]
[[nodiscard]] std::size_t memory_budget(std::size_t asked_bytes, const std::filesystem::path& root = "/");

}  // namespace kilter::app
