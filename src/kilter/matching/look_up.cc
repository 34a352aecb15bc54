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

namespace baseline {

#include "kilter/matching/look_up_columns.inc"

// All addresses first: memory is waited for once.
std::uint32_t read_cells(const FieldCell* const* table, const CellPlaces& places, std::size_t first,
                         VoxelColumn& voxels) {
  std::array<const FieldCell*, kTogether> cells{};
  std::uint32_t missing = 0;
  for (std::size_t k = 0; k < kTogether; ++k) {
    const std::int32_t slot = places.slot[first + k];
    cells[k] = &kNoVoxel;
    if (slot == CellPlaces::kOutside) continue;
    const FieldCell* const block = std::atomic_ref(table[slot]).load(std::memory_order_acquire);
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

constexpr LookUpKernels kKernels = {move, find_places, read_cells, take_rows, measure};

}  // namespace baseline

#if defined(__x86_64__)
KILTER_BEGIN_TARGET("avx2")
namespace avx2 {

#include "kilter/matching/look_up_columns.inc"  // NOLINT(readability-duplicate-include): for each

constexpr LookUpKernels kKernels = {move, find_places, baseline::read_cells, baseline::take_rows, measure};

}  // namespace avx2
KILTER_END_TARGET

KILTER_BEGIN_TARGET("avx512f")
namespace avx512 {

#include "kilter/matching/look_up_columns.inc"  // NOLINT(readability-duplicate-include): for each

constexpr __mmask8 kAll = 0xFF;  // of what is not masked g++ 12 thinks that it is not initialized

// The lanes of a gather are loads of their own and in order, as any load of this processor: what a block's builder
// wrote before its address is there with it.
std::uint32_t read_cells(const FieldCell* const* table, const CellPlaces& places, std::size_t first,
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

const LookUpKernels& look_up_kernels(VectorPath path) { return KILTER_OF_PATH(path, kKernels); }

}  // namespace kilter
