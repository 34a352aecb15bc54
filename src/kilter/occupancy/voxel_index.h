// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>

namespace kilter {

/// A voxel of a lattice with spacing r and a corner at the frame's origin: index i covers [i r, (i+1) r).
using VoxelIndex = Eigen::Vector3i;

/// Voxels live in blocks of 8 x 8 x 8. Inside a block bit x + 8 (y + 8 z) stands for voxel (x, y, z): one 64-bit word
/// per z layer, one byte per row in x.
inline constexpr int kBlockShift = 3;
inline constexpr int kBlockSize = 1 << kBlockShift;
inline constexpr int kBlockVoxels = kBlockSize * kBlockSize * kBlockSize;

/// Lattice coordinates must stay within +- kMaxVoxelIndex (200 km at 0.1 m): 21 bits an axis in a block key.
inline constexpr int kMaxVoxelIndex = 1 << 21;

/// Sorts blocks by z, then y, then x.
[[nodiscard]] inline std::uint64_t block_key(const Eigen::Vector3i& block) {
  constexpr int kBias = 1 << 20;
  const auto axis = [](int value) { return static_cast<std::uint64_t>(value + kBias) & 0x1FFFFF; };
  return axis(block.z()) << 42 | axis(block.y()) << 21 | axis(block.x());
}

[[nodiscard]] inline Eigen::Vector3i block_of_key(std::uint64_t key) {
  constexpr int kBias = 1 << 20;
  const auto axis = [&](int shift) { return static_cast<int>(key >> shift & 0x1FFFFF) - kBias; };
  return {axis(0), axis(21), axis(42)};
}

[[nodiscard]] inline Eigen::Vector3i block_of(const VoxelIndex& voxel) {
  return {voxel.x() >> kBlockShift, voxel.y() >> kBlockShift, voxel.z() >> kBlockShift};
}

/// Position of the voxel inside its block, as bit number 0..511.
[[nodiscard]] inline int bit_of(const VoxelIndex& voxel) {
  constexpr int kMask = kBlockSize - 1;
  return (voxel.x() & kMask) | (voxel.y() & kMask) << 3 | (voxel.z() & kMask) << 6;
}

[[nodiscard]] inline VoxelIndex voxel_of(const Eigen::Vector3i& block, int bit) {
  return block * kBlockSize + Eigen::Vector3i(bit & 7, bit >> 3 & 7, bit >> 6);
}

/// The largest whole number that is not above, without the call that rounding down is on processors of old.
[[nodiscard]] inline std::int32_t whole_below(double value) {
  const auto truncated = static_cast<std::int32_t>(value);
  const std::uint32_t above = static_cast<double>(truncated) > value ? 1 : 0;
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(truncated) - above);
}

/// Multiplies by 1 / r as OctoMap's keys do: dividing by r decides otherwise on some borders.
[[nodiscard]] inline VoxelIndex voxel_at(const Eigen::Vector3d& point_m, double resolution_m) {
  const Eigen::Vector3d scaled = point_m * (1.0 / resolution_m);
  return {whole_below(scaled.x()), whole_below(scaled.y()), whole_below(scaled.z())};
}

/// Whether voxel_at() of such a point, and of its neighbours, is on the lattice; beyond that it means nothing.
[[nodiscard]] inline bool on_lattice(const Eigen::Vector3d& point_m, double resolution_m) {
  const double end_m = resolution_m * (kMaxVoxelIndex - 1);
  return std::abs(point_m.x()) < end_m && std::abs(point_m.y()) < end_m && std::abs(point_m.z()) < end_m;
}

[[nodiscard]] inline Eigen::Vector3d voxel_centre(const VoxelIndex& voxel, double resolution_m) {
  return (voxel.cast<double>() + Eigen::Vector3d::Constant(0.5)) * resolution_m;
}

}  // namespace kilter
