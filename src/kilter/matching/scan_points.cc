// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/scan_points.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

namespace kilter {
namespace {

// g++ 12 takes the size of a vector from no template's argument.
template <std::uint32_t kLanes>
struct Register;
template <>
struct Register<4> {
  using Floats = float __attribute__((vector_size(16)));
  using Ints = std::int32_t __attribute__((vector_size(16)));
};
template <>
struct Register<8> {
  using Floats = float __attribute__((vector_size(32)));
  using Ints = std::int32_t __attribute__((vector_size(32)));
};
template <>
struct Register<16> {
  using Floats = float __attribute__((vector_size(64)));
  using Ints = std::int32_t __attribute__((vector_size(64)));
};

// Written once for any number of lanes; each caller's target decides which registers they become.
template <std::uint32_t kLanes>
[[gnu::always_inline]] inline void scan(const PackedPoints& points, std::uint32_t first, std::uint32_t end,
                                        const float* point, NearestPoint& best) {
  using Lanes = typename Register<kLanes>::Floats;
  using IntLanes = typename Register<kLanes>::Ints;
  const float* const x = points.x.data();
  const float* const y = points.y.data();
  const float* const z = points.z.data();
  Lanes least2 = Lanes{} + std::numeric_limits<float>::max();
  IntLanes least{};
  IntLanes at{};
  for (std::uint32_t lane = 0; lane < kLanes; ++lane) at[lane] = static_cast<std::int32_t>(first + lane);
  for (std::uint32_t i = first; i < end; i += kLanes) {
    Lanes dx;
    Lanes dy;
    Lanes dz;
    std::memcpy(&dx, x + i, sizeof(dx));
    std::memcpy(&dy, y + i, sizeof(dy));
    std::memcpy(&dz, z + i, sizeof(dz));
    dx -= point[0];
    dy -= point[1];
    dz -= point[2];
    const Lanes square = dx * dx + dy * dy + dz * dz;
    const IntLanes is_less = square < least2;
    least2 = is_less ? square : least2;
    least = is_less ? at : least;  // of equal ones the first of each lane stays
    at += static_cast<std::int32_t>(kLanes);
  }
  std::array<float, kLanes> squares{};
  std::memcpy(squares.data(), &least2, sizeof(least2));
  std::array<float, kLanes> halves = squares;
  for (std::uint32_t half = kLanes / 2; half > 0; half /= 2) {
    for (std::uint32_t lane = 0; lane < half; ++lane) halves[lane] = std::min(halves[lane], halves[lane + half]);
  }
  if (halves[0] > best.square_m2) return;
  // Of equal ones in several lanes the first.
  std::uint32_t index = std::numeric_limits<std::uint32_t>::max();
  for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
    if (squares[lane] == halves[0]) index = std::min(index, static_cast<std::uint32_t>(least[lane]));
  }
  if (halves[0] == best.square_m2 && index > best.index) return;
  best = {halves[0], index};
}

void scan_baseline(const PackedPoints& points, std::uint32_t first, std::uint32_t end, const float* point,
                   NearestPoint& best) {
  scan<4>(points, first, end, point, best);
}

#if defined(__x86_64__)
[[gnu::target("avx2")]] void scan_avx2(const PackedPoints& points, std::uint32_t first, std::uint32_t end,
                                       const float* point, NearestPoint& best) {
  scan<8>(points, first, end, point, best);
}

[[gnu::target("avx512f")]] void scan_avx512(const PackedPoints& points, std::uint32_t first, std::uint32_t end,
                                            const float* point, NearestPoint& best) {
  scan<16>(points, first, end, point, best);
}
#endif

std::vector<VectorPath> paths_of_processor() {
  std::vector<VectorPath> paths = {VectorPath::kBaseline};
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) paths.push_back(VectorPath::kAvx2);
  if (__builtin_cpu_supports("avx512f")) paths.push_back(VectorPath::kAvx512);
#endif
  return paths;
}

}  // namespace

std::span<const VectorPath> vector_paths() {
  static const std::vector<VectorPath> kPaths = paths_of_processor();
  return kPaths;
}

ScanPoints scan_points_with(VectorPath path) {
#if defined(__x86_64__)
  if (path == VectorPath::kAvx512) return scan_avx512;
  if (path == VectorPath::kAvx2) return scan_avx2;
#else
  static_cast<void>(path);
#endif
  return scan_baseline;
}

}  // namespace kilter
