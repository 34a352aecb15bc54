// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

// What writer and reader of result.kilter share; docs/archive.md tells it in full.
namespace kilter::archive_format {

inline constexpr std::string_view kMagic = "\x89KILTER\n";
inline constexpr std::uint32_t kVersion = 1;
inline constexpr std::array<std::string_view, 4> kTags = {"JSON", "PATH", "CLDS", "PAIR"};

inline constexpr std::size_t kBytesPerPoint = 7;  // three coordinates of two bytes, misalignment

// Flags of a pair.
inline constexpr unsigned kHasAfter = 1;
inline constexpr unsigned kHasHistogram = 2;
inline constexpr unsigned kHasParent = 4;

/// CRC-32 as zlib, PNG and zip have it.
[[nodiscard]] std::uint32_t checksum(std::string_view bytes);

}  // namespace kilter::archive_format
