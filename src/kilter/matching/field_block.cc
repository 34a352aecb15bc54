// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/field_block.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <span>

#include "kilter/base/vector_target.h"
#include "kilter/matching/registers.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

// Vectors wider than the target's registers are taken and returned by what becomes part of one function.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace kilter {
namespace {

// The blocks around a block that its answers may lie in, and their cells.
constexpr int kMostAround = 2 * OccupiedBlocks::kMargin + 1;
constexpr int kMostWidth = kBlockSize * kMostAround;

// A voxel among those cells and how far it is: the square above, then z, y and x. The least one is the answer.
constexpr int kAxisBits = 6;
constexpr int kSquareShift = 3 * kAxisBits;
static_assert(kMostWidth <= 1 << kAxisBits);

// So many cells off along one axis, or more: beyond reach, and no sum of squares reaches the sign.
constexpr int kFarOff = 50;
constexpr int kMostOff = kMostFieldReach + kBlockSize - 1;
static_assert(kFarOff > kMostFieldReach);
static_assert(std::int64_t{kFarOff * kFarOff + 2 * kMostOff * kMostOff + 1} << kSquareShift < INT32_MAX);
constexpr std::int32_t kFar = (kFarOff * kFarOff) << kSquareShift;

// A block that holds voxels, and where: from the first of those around.
struct Neighbour {
  const VoxelBlock* block;
  int x, y, z;
};

// The occupied cells around a block. Large, and filled in part only: what is not said to be filled is not read.
// NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): zeros that nobody reads cost more than the filling
struct Window {
  int ring = 0;                                                               // blocks on each side
  std::size_t count = 0;                                                      // of the neighbours
  std::array<Neighbour, kMostAround * kMostAround * kMostAround> neighbours;  // by z, y and x
  // By the number of a block around, x lowest, three bits an axis, and then by layer: its occupied cells and the number
  // of its first voxel. Behind them all one that holds nothing.
  static constexpr std::size_t kLayers = 1 << (3 * 3 + kBlockShift);
  std::array<std::uint64_t, kLayers + 1> layers;
  std::array<std::uint32_t, kLayers + 1> first_voxel;
  // A bit for each cell of a row along x, by z and y.
  std::array<std::array<std::uint64_t, kMostWidth>, kMostWidth> rows;
  // A bit for each y whose row is filled.
  std::array<std::uint64_t, kMostWidth> filled;
};

// A bit for each byte that is not zero.
std::uint32_t bytes_in_use(std::uint64_t bytes) {
  constexpr std::uint64_t kLow = 0x7F7F7F7F7F7F7F7F;
  const std::uint64_t used = (((bytes & kLow) + kLow) | bytes) >> 7 & 0x0101010101010101;
  return static_cast<std::uint32_t>(used * 0x0102040810204080 >> 56);
}

// All of them first: memory is waited for once.
void find_neighbours(const VoxelMap& map, const OccupiedBlocks& occupied, const FieldBox& box,
                     const Eigen::Vector3i& at, Window& window) {
  const Eigen::Vector3i low = at - Eigen::Vector3i::Constant(window.ring);
  const int around = 2 * window.ring + 1;
  window.count = 0;
  for (int z = 0; z < around; ++z) {
    for (int y = 0; y < around; ++y) {
      std::uint32_t todo = occupied.eight_from(low.x(), low.y() + y, low.z() + z) & ((1U << around) - 1);
      for (; todo != 0; todo &= todo - 1) {
        const int x = std::countr_zero(todo);
        const std::int32_t number = map.find_block(box.low + low + Eigen::Vector3i(x, y, z));
        const VoxelBlock* const block = map.blocks().data() + number;
        __builtin_prefetch(&block->occupied);
        __builtin_prefetch(&block->first_voxel);
        window.neighbours[window.count++] = {block, x, y, z};
      }
    }
  }
}

using Row = Register<kBlockSize>::Ints;  // the cells of one y and z

// Of eight cells in a row, some of which are occupied: where the nearest one is that is not to the right of each, or
// not to its left; beyond all cells where there is none.
struct NearestOfEight {
  static constexpr std::int32_t kNone = 2 * kMostWidth;
  using All = std::array<std::array<std::int32_t, kBlockSize>, 1 << kBlockSize>;
  alignas(64) All left{};
  alignas(64) All right{};
};

constexpr NearestOfEight kNearestOfEight = [] {
  NearestOfEight nearest;
  for (std::size_t bits = 0; bits < nearest.left.size(); ++bits) {
    std::int32_t left = -NearestOfEight::kNone;
    std::int32_t right = NearestOfEight::kNone;
    for (std::int32_t x = 0; x < kBlockSize; ++x) {
      const std::int32_t from_end = kBlockSize - 1 - x;
      if ((bits >> x & 1) != 0) left = x;
      if ((bits >> from_end & 1) != 0) right = from_end;
      nearest.left[bits][static_cast<std::size_t>(x)] = left;
      nearest.right[bits][static_cast<std::size_t>(from_end)] = right;
    }
  }
  return nearest;
}();

// The cells of a block along x.
constexpr Row kColumns = {0, 1, 2, 3, 4, 5, 6, 7};

// What being so many cells off along one axis adds to each key of a row, for all that a cell of the block and one of
// the window can be: the farthest first.
constexpr auto kLifts = [] {
  std::array<std::array<std::int32_t, kBlockSize>, 2 * kMostOff + 1> lifts{};
  int off = kMostOff;
  for (auto& lift : lifts) {
    lift.fill((off * off) << kSquareShift);
    --off;
  }
  return lifts;
}();

namespace baseline {

using Ints = Row;
constexpr std::size_t kTogether = 1;
[[gnu::always_inline]] inline Row least(const Row& a, const Row& b) { return a < b ? a : b; }
[[gnu::always_inline]] inline Row repeated(const Row& row) { return row; }

#include "kilter/matching/field_block.inc"

}  // namespace baseline

#if defined(__x86_64__)
KILTER_BEGIN_TARGET("avx2,popcnt,lzcnt,bmi,bmi2")
namespace avx2 {

using Ints = Row;
constexpr std::size_t kTogether = 1;
inline Row least(const Row& a, const Row& b) { return a < b ? a : b; }
inline Row repeated(const Row& row) { return row; }

#include "kilter/matching/field_block.inc"  // NOLINT(readability-duplicate-include): for each

}  // namespace avx2
KILTER_END_TARGET

KILTER_BEGIN_TARGET("avx512f,avx2,popcnt,lzcnt,bmi,bmi2")
namespace avx512 {

using Ints = Register<16>::Ints;
constexpr std::size_t kTogether = 2;
inline Row least(const Row& a, const Row& b) { return a < b ? a : b; }
// g++ 12 makes a comparison and a masked move of the same on wide registers.
inline Ints least(const Ints& a, const Ints& b) {
  constexpr __mmask16 kAll = 0xFFFF;  // of what is not masked it thinks that it is not initialized
  return reinterpret_cast<Ints>(
      _mm512_maskz_min_epi32(kAll, reinterpret_cast<__m512i>(a), reinterpret_cast<__m512i>(b)));
}
inline Ints repeated(const Row& row) {
  return __builtin_shufflevector(row, row, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
}

#include "kilter/matching/field_block.inc"  // NOLINT(readability-duplicate-include): for each

}  // namespace avx512
KILTER_END_TARGET
#endif

}  // namespace

OccupiedBlocks::OccupiedBlocks(const VoxelMap& map, const FieldBox& box)
    : size_(box.size), row_bytes_((static_cast<std::size_t>(box.size.x()) + 2 * kMargin + 7) / 8 + 1) {
  bits_.resize(static_cast<std::size_t>(size_.z()) * size_.y() * row_bytes_);
  for (const VoxelBlock& block : map.blocks()) {
    if (block.voxel_count == 0) continue;
    const Eigen::Vector3i at = block_of_key(block.key) - box.low;
    const std::size_t bit = static_cast<std::uint32_t>(at.x() + kMargin);
    const std::size_t row = static_cast<std::size_t>(at.z()) * size_.y() + at.y();
    bits_[row * row_bytes_ + bit / 8] |= static_cast<std::uint8_t>(1U << bit % 8);
  }
}

bool compute_field_block(const VoxelMap& map, const OccupiedBlocks& occupied, const FieldBox& box,
                         const Eigen::Vector3i& at, int reach, VectorPath path, FieldBlock& voxels) {
  return KILTER_OF_PATH(path, compute)(map, occupied, box, at, reach, voxels);
}

}  // namespace kilter
