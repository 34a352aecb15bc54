// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>

#include "kilter/base/vector_path.h"
#include "kilter/matching/point_columns.h"

namespace kilter {

/// No voxel is near, or none is known to be.
inline constexpr std::uint32_t kNoVoxel = 0xFFFFFFFF;

/// A cell of a field: a voxel's number or kNoVoxel. A block's stand one after the other, by bit_of.
using FieldCell = std::uint32_t;

/// Blocks of a lattice in a box, x fastest, a place for each in a table.
struct FieldBox {
  Eigen::Vector3i low = Eigen::Vector3i::Zero();   ///< first block
  Eigen::Vector3i size = Eigen::Vector3i::Zero();  ///< blocks on each axis
};

/// Voxel numbers of one batch.
struct VoxelColumn {
  alignas(64) std::array<std::uint32_t, PointColumns::kMost> number{};

  [[nodiscard]] std::uint32_t& operator[](std::size_t k) { return number[k]; }
  [[nodiscard]] std::uint32_t operator[](std::size_t k) const { return number[k]; }
};

/// Where each point of a batch reads: its block's place in the table, or kOutside, and the bit of its cell.
struct CellPlaces {
  static constexpr std::int32_t kOutside = -1;
  alignas(64) std::array<std::int32_t, PointColumns::kMost> slot;
  alignas(64) std::array<std::int32_t, PointColumns::kMost> bit;
};

/// A transform as numbers, for loops that the compiler makes registers of.
struct Transform {
  std::array<std::array<double, 3>, 3> turn{};
  std::array<double, 3> shift_m{};

  explicit Transform(const Eigen::Isometry3d& T) {
    for (int row = 0; row < 3; ++row) {
      const auto to = static_cast<std::size_t>(row);
      turn[to] = {T(row, 0), T(row, 1), T(row, 2)};
      shift_m[to] = T(row, 3);
    }
  }
};

/// What looking up one batch is made of. Counts are at most PointColumns::kMost; what the first `count` elements say
/// does not depend on the path, and what stands behind them means nothing.
struct LookUpKernels {
  void (*move)(const Transform& T, const FloatColumns& points_m, std::size_t count, PointColumns& moved_m);
  /// \param per_metre  cells.
  void (*find_places)(const PointColumns& points_m, std::size_t count, double per_metre, const FieldBox& box,
                      CellPlaces& places);
  /// Reads what stands at places [first, first + kTogether) of blocks that are there. \return a bit for each of them
  /// whose block is not there yet, and then none are read.
  std::uint32_t (*read_cells)(const FieldCell* const* table, const CellPlaces& places, std::size_t first,
                              VoxelColumn& voxels);
  /// Rows of these numbers; zeros for kNoVoxel.
  void (*take_rows)(const Eigen::Vector3f* rows, const VoxelColumn& numbers, std::size_t count, FloatColumns& taken);
  /// Square distances. [m^2]
  void (*measure)(const PointColumns& points_m, const FloatColumns& others_m, std::size_t count,
                  std::array<double, PointColumns::kMost>& square_m2);

  static constexpr std::size_t kTogether = 8;
};

[[nodiscard]] const LookUpKernels& look_up_kernels(VectorPath path);

}  // namespace kilter
