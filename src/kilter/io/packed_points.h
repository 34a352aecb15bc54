// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "kilter/base/expected.h"

namespace kilter {

/// How many points packed bytes may hold. Those of lidars take three bytes and more however they are packed, since no
/// two are alike; so many of which all are the same are only there to take memory ...
inline constexpr std::uint64_t kMostPointsAPackedByte = 1;
/// ... except that scans are smaller than this, of which a covered sensor makes nothing but zeros.
inline constexpr std::uint64_t kFreePackedPoints = std::uint64_t{1} << 20;

/// Whether a cloud may be unpacked. \param packed_bytes  what it is unpacked from, and whatever else. \return
/// kUnsupported if it claims too many points.
[[nodiscard]] Expected<void> check_packed_points(std::uint64_t points, std::uint64_t packed_bytes,
                                                 const std::string& where);

}  // namespace kilter
