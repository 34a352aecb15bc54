// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "kilter/occupancy/voxel_map.h"

namespace kilter {

/// A map as bytes for this very program to read again while it runs: memory as it lies, and a checksum. No file format:
/// nothing of it is promised to another machine, another build or tomorrow.
[[nodiscard]] std::vector<std::byte> bytes_of_map(const VoxelMap& map);

/// The same map to the bit; absent if these are not the bytes that bytes_of_map gave. O(bytes).
[[nodiscard]] std::optional<VoxelMap> map_of_bytes(std::span<const std::byte> bytes);

}  // namespace kilter
