// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/look_up.h"

#include <atomic>

#include "kilter/base/vector_target.h"
#include "kilter/occupancy/voxel_index.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace kilter {
namespace {

constexpr std::size_t kTogether = LookUpKernels::kTogether;

// Plain arithmetic: the compiler makes registers of it.
[[gnu::always_inline]] inline void find_places_in_box(const PointColumns& points_m, std::size_t count, double per_metre,
                                                      const FieldBox& box, CellPlaces& places) {
  const std::array<std::int32_t, 3> from = {box.low.x(), box.low.y(), box.low.z()};
  const std::array<std::uint32_t, 3> blocks = {static_cast<std::uint32_t>(box.size.x()),
                                               static_cast<std::uint32_t>(box.size.y()),
                                               static_cast<std::uint32_t>(box.size.z())};
  constexpr std::int32_t kInside = kBlockSize - 1;
  for (std::size_t k = 0; k < count; ++k) {
    const std::int32_t x = whole_below(points_m.x[k] * per_metre);
    const std::int32_t y = whole_below(points_m.y[k] * per_metre);
    const std::int32_t z = whole_below(points_m.z[k] * per_metre);
    const auto block_x = static_cast<std::uint32_t>((x >> kBlockShift) - from[0]);
    const auto block_y = static_cast<std::uint32_t>((y >> kBlockShift) - from[1]);
    const auto block_z = static_cast<std::uint32_t>((z >> kBlockShift) - from[2]);
    const auto slot = static_cast<std::int32_t>((block_z * blocks[1] + block_y) * blocks[0] + block_x);
    // One comparison a line: g++ 12 makes single steps of a condition that joins several.
    std::int32_t found = block_x < blocks[0] ? slot : CellPlaces::kOutside;
    found = block_y < blocks[1] ? found : CellPlaces::kOutside;
    found = block_z < blocks[2] ? found : CellPlaces::kOutside;
    places.slot[k] = found;
    places.bit[k] = (x & kInside) | (y & kInside) << kBlockShift | (z & kInside) << (2 * kBlockShift);
  }
}

// To the bit what Eigen makes of T * point.
[[gnu::always_inline]] inline void move_each(const Transform& to, const FloatColumns& points_m, std::size_t count,
                                             PointColumns& moved_m) {
  const Transform T = to;  // which is not written to meanwhile
  for (std::size_t k = 0; k < count; ++k) {
    const double x_m = points_m.x[k];
    const double y_m = points_m.y[k];
    const double z_m = points_m.z[k];
    moved_m.x[k] = T.turn[0][0] * x_m + T.turn[0][1] * y_m + T.turn[0][2] * z_m + T.shift_m[0];
    moved_m.y[k] = T.turn[1][0] * x_m + T.turn[1][1] * y_m + T.turn[1][2] * z_m + T.shift_m[1];
    moved_m.z[k] = T.turn[2][0] * x_m + T.turn[2][1] * y_m + T.turn[2][2] * z_m + T.shift_m[2];
  }
}

[[gnu::always_inline]] inline void measure_each(const PointColumns& points_m, const FloatColumns& others_m,
                                                std::size_t count, std::array<double, PointColumns::kMost>& square_m2) {
  for (std::size_t k = 0; k < count; ++k) {
    const double x_m = others_m.x[k] - points_m.x[k];
    const double y_m = others_m.y[k] - points_m.y[k];
    const double z_m = others_m.z[k] - points_m.z[k];
    square_m2[k] = x_m * x_m + y_m * y_m + z_m * z_m;
  }
}

namespace baseline {

void move(const Transform& T, const FloatColumns& points_m, std::size_t count, PointColumns& moved_m) {
  move_each(T, points_m, count, moved_m);
}

void find_places(const PointColumns& points_m, std::size_t count, double per_metre, const FieldBox& box,
                 CellPlaces& places) {
  find_places_in_box(points_m, count, per_metre, box, places);
}

// All addresses first: memory is waited for once.
std::uint32_t read_cells(const FieldCells* const* table, const CellPlaces& places, std::size_t first,
                         VoxelColumn& voxels) {
  std::array<const FieldCells*, kTogether> cells{};
  std::uint32_t missing = 0;
  for (std::size_t k = 0; k < kTogether; ++k) {
    const std::int32_t slot = places.slot[first + k];
    cells[k] = &kNoVoxel;
    if (slot == CellPlaces::kOutside) continue;
    const FieldCells* const block = std::atomic_ref(table[slot]).load(std::memory_order_acquire);
    if (block == nullptr) {
      missing |= 1U << k;
      continue;
    }
    cells[k] = block + places.bit[first + k];
    __builtin_prefetch(cells[k]);
  }
  if (missing != 0) return missing;
  for (std::size_t k = 0; k < kTogether; ++k) voxels[first + k] = *cells[k];
  return 0;
}

void take_rows(const Eigen::Vector3f* rows, const VoxelColumn& numbers, std::size_t count, FloatColumns& taken) {
  for (std::size_t k = 0; k < count; ++k) {
    if (numbers[k] != kNoVoxel) __builtin_prefetch(rows + numbers[k]);
  }
  for (std::size_t k = 0; k < count; ++k) {
    const bool any = numbers[k] != kNoVoxel;
    const Eigen::Vector3f zero = Eigen::Vector3f::Zero();
    taken.set(k, any ? rows[numbers[k]] : zero);
  }
}

void measure(const PointColumns& points_m, const FloatColumns& others_m, std::size_t count,
             std::array<double, PointColumns::kMost>& square_m2) {
  measure_each(points_m, others_m, count, square_m2);
}

constexpr LookUpKernels kKernels = {move, find_places, read_cells, take_rows, measure};

}  // namespace baseline

#if defined(__x86_64__)
KILTER_BEGIN_TARGET("avx2")
namespace avx2 {

void move(const Transform& T, const FloatColumns& points_m, std::size_t count, PointColumns& moved_m) {
  move_each(T, points_m, count, moved_m);
}

void find_places(const PointColumns& points_m, std::size_t count, double per_metre, const FieldBox& box,
                 CellPlaces& places) {
  find_places_in_box(points_m, count, per_metre, box, places);
}

void measure(const PointColumns& points_m, const FloatColumns& others_m, std::size_t count,
             std::array<double, PointColumns::kMost>& square_m2) {
  measure_each(points_m, others_m, count, square_m2);
}

constexpr LookUpKernels kKernels = {move, find_places, baseline::read_cells, baseline::take_rows, measure};

}  // namespace avx2
KILTER_END_TARGET

KILTER_BEGIN_TARGET("avx512f")
namespace avx512 {

void move(const Transform& T, const FloatColumns& points_m, std::size_t count, PointColumns& moved_m) {
  move_each(T, points_m, count, moved_m);
}

void find_places(const PointColumns& points_m, std::size_t count, double per_metre, const FieldBox& box,
                 CellPlaces& places) {
  find_places_in_box(points_m, count, per_metre, box, places);
}

void measure(const PointColumns& points_m, const FloatColumns& others_m, std::size_t count,
             std::array<double, PointColumns::kMost>& square_m2) {
  measure_each(points_m, others_m, count, square_m2);
}

constexpr __mmask8 kAll = 0xFF;  // of what is not masked g++ 12 thinks that it is not initialized

// The lanes of a gather are loads of their own and in order, as any load of this processor: what a block's builder
// wrote before its address is there with it.
std::uint32_t read_cells(const FieldCells* const* table, const CellPlaces& places, std::size_t first,
                         VoxelColumn& voxels) {
  const __m512i slots = _mm512_maskz_cvtepi32_epi64(
      kAll, _mm256_load_si256(reinterpret_cast<const __m256i*>(places.slot.data() + first)));
  const __m512i bits =
      _mm512_maskz_cvtepi32_epi64(kAll, _mm256_load_si256(reinterpret_cast<const __m256i*>(places.bit.data() + first)));
  const __mmask8 inside = _mm512_cmpge_epi64_mask(slots, _mm512_setzero_si512());
  const __m512i blocks = _mm512_mask_i64gather_epi64(_mm512_setzero_si512(), inside, slots, table, sizeof(*table));
  const __mmask8 missing = _mm512_mask_testn_epi64_mask(inside, blocks, blocks);
  if (missing != 0) return missing;
  const __m512i cells = _mm512_add_epi64(blocks, _mm512_maskz_slli_epi64(kAll, bits, 2));
  const __m256i none = _mm256_set1_epi32(-1);
  const __m256i found = _mm512_mask_i64gather_epi32(none, inside, cells, nullptr, 1);
  _mm256_store_si256(reinterpret_cast<__m256i*>(voxels.number.data() + first), found);
  return 0;
}

void take_rows(const Eigen::Vector3f* rows, const VoxelColumn& numbers, std::size_t count, FloatColumns& taken) {
  constexpr std::size_t kLanes = 16;
  const float* const coordinates = rows->data();
  for (std::size_t k = 0; k < count; k += kLanes) {
    const __m512i number = _mm512_load_si512(numbers.number.data() + k);
    const auto within = static_cast<__mmask16>(count - k < kLanes ? (1U << (count - k)) - 1 : 0xFFFF);
    const __mmask16 any = _mm512_mask_cmpneq_epi32_mask(within, number, _mm512_set1_epi32(-1));
    const __m512i at = _mm512_add_epi32(number, _mm512_add_epi32(number, number));
    const __m512 zero = _mm512_setzero_ps();
    _mm512_store_ps(taken.x.data() + k, _mm512_mask_i32gather_ps(zero, any, at, coordinates, sizeof(float)));
    _mm512_store_ps(taken.y.data() + k, _mm512_mask_i32gather_ps(zero, any, at, coordinates + 1, sizeof(float)));
    _mm512_store_ps(taken.z.data() + k, _mm512_mask_i32gather_ps(zero, any, at, coordinates + 2, sizeof(float)));
  }
}

constexpr LookUpKernels kKernels = {move, find_places, read_cells, take_rows, measure};

}  // namespace avx512
KILTER_END_TARGET
#endif

}  // namespace

const LookUpKernels& look_up_kernels(VectorPath path) {
#if defined(__x86_64__)
  if (path == VectorPath::kAvx512) return avx512::kKernels;
  if (path == VectorPath::kAvx2) return avx2::kKernels;
#else
  static_cast<void>(path);
#endif
  return baseline::kKernels;
}

}  // namespace kilter
