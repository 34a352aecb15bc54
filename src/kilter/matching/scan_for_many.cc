// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/scan_for_many.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "kilter/base/vector_target.h"
#include "kilter/matching/cluster_gaps.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace kilter {
namespace {

// Groups whose gaps are remembered; more are looked through in parts.
constexpr std::size_t kMostGroups = 64;

// Of two points for each lane the nearer one stays; of equals the one with the lower number.
template <std::uint32_t kLanes>
[[gnu::always_inline]] inline void keep_nearer_of(const typename Register<kLanes>::Floats& found_m2,
                                                  const typename Register<kLanes>::Ints& found,
                                                  typename Register<kLanes>::Floats& square_m2,
                                                  typename Register<kLanes>::Ints& number) {
  using Ints = typename Register<kLanes>::Ints;
  const Ints none = Ints{} + ClusteredPoints::kNoNumber;
  const typename Register<kLanes>::Floats least_m2 = found_m2 < square_m2 ? found_m2 : square_m2;
  const Ints new_one = found_m2 == least_m2 ? found : none;
  const Ints old_one = square_m2 == least_m2 ? number : none;
  number = new_one < old_one ? new_one : old_one;
  square_m2 = least_m2;
}

namespace baseline {
constexpr std::uint32_t kLanes = 4;

#if defined(__x86_64__)
static inline std::uint32_t lanes_at_most(const __m128& a, const __m128& b) {
  return static_cast<std::uint32_t>(_mm_movemask_ps(_mm_cmple_ps(a, b)));
}
#else
static inline std::uint32_t lanes_at_most(const Register<kLanes>::Floats& a, const Register<kLanes>::Floats& b) {
  const Register<kLanes>::Ints bits = {1, 2, 4, 8};
  return any_of<kLanes>(a <= b ? bits : Register<kLanes>::Ints{});
}
#endif
static inline float largest(const Register<kLanes>::Floats& lanes) { return largest_of<kLanes>(lanes); }

static inline void keep_nearer(const Register<kLanes>::Floats& found_m2, const Register<kLanes>::Ints& found,
                               Register<kLanes>::Floats& square_m2, Register<kLanes>::Ints& number) {
  keep_nearer_of<kLanes>(found_m2, found, square_m2, number);
}
#include "kilter/matching/many_search.inc"
}  // namespace baseline

#if defined(__x86_64__)
KILTER_BEGIN_TARGET("avx2,bmi")
namespace avx2 {
constexpr std::uint32_t kLanes = 8;

static inline std::uint32_t lanes_at_most(const __m256& a, const __m256& b) {
  return static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LE_OQ)));
}
static inline float largest(const __m256& lanes) { return largest_of<kLanes>(lanes); }
static inline void keep_nearer(const __m256& found_m2, const Register<kLanes>::Ints& found,
                               Register<kLanes>::Floats& square_m2, Register<kLanes>::Ints& number) {
  keep_nearer_of<kLanes>(found_m2, found, square_m2, number);
}
#include "kilter/matching/many_search.inc"  // NOLINT(readability-duplicate-include): for each
}  // namespace avx2
KILTER_END_TARGET

KILTER_BEGIN_TARGET("avx512f,bmi")
namespace avx512 {
constexpr std::uint32_t kLanes = 16;

static inline std::uint32_t lanes_at_most(const __m512& a, const __m512& b) {
  return _mm512_cmp_ps_mask(a, b, _CMP_LE_OQ);
}
static inline float largest(const __m512& lanes) { return largest_of<kLanes>(lanes); }
static inline void keep_nearer(const __m512& found_m2, const Register<kLanes>::Ints& found,
                               Register<kLanes>::Floats& square_m2, Register<kLanes>::Ints& number) {
  const __mmask16 nearer = _mm512_cmp_ps_mask(found_m2, square_m2, _CMP_LT_OQ);
  const __mmask16 as_near = _mm512_cmp_ps_mask(found_m2, square_m2, _CMP_EQ_OQ);
  const __m512i of_lanes = reinterpret_cast<__m512i>(number);
  const auto found_of_lanes = reinterpret_cast<__m512i>(found);
  const __m512i lower = _mm512_mask_min_epi32(of_lanes, as_near, of_lanes, found_of_lanes);
  number = reinterpret_cast<Register<kLanes>::Ints>(_mm512_mask_mov_epi32(lower, nearer, found_of_lanes));
  square_m2 = _mm512_mask_mov_ps(square_m2, nearer, found_m2);
}
#include "kilter/matching/many_search.inc"  // NOLINT(readability-duplicate-include): for each
}  // namespace avx512
KILTER_END_TARGET
#endif

}  // namespace

ManySearchKernels many_search_kernels(VectorPath path) { return KILTER_OF_PATH(path, kKernels); }

}  // namespace kilter
