// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/base/vector_path.h"

#if defined(__x86_64__)
#include <cpuid.h>
#endif

#include <vector>

namespace kilter {
namespace {

#if defined(__x86_64__)
// clang 14 does not know it by name.
bool has_lzcnt() {
  unsigned int a = 0;
  unsigned int b = 0;
  unsigned int c = 0;
  unsigned int d = 0;
  return __get_cpuid(0x80000001, &a, &b, &c, &d) != 0 && (c & bit_LZCNT) != 0;
}

// All that kernels are compiled for beside the registers themselves; virtual machines may hide some of it.
bool has_bit_counts() {
  return __builtin_cpu_supports("popcnt") && has_lzcnt() && __builtin_cpu_supports("bmi") &&
         __builtin_cpu_supports("bmi2");
}
#endif

std::vector<VectorPath> paths_of_processor() {
  std::vector<VectorPath> paths = {VectorPath::kBaseline};
#if defined(__x86_64__)
  const bool has_avx2 = __builtin_cpu_supports("avx2") && has_bit_counts();
  if (has_avx2) paths.push_back(VectorPath::kAvx2);
  if (has_avx2 && __builtin_cpu_supports("avx512f")) paths.push_back(VectorPath::kAvx512);
#elif defined(__aarch64__)
  paths.push_back(VectorPath::kNeon);
#endif
  return paths;
}

}  // namespace

std::span<const VectorPath> vector_paths() {
  static const std::vector<VectorPath> kPaths = paths_of_processor();
  return kPaths;
}

}  // namespace kilter
