// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/matching/vector_path.h"

#include <vector>

namespace kilter {
namespace {

std::vector<VectorPath> paths_of_processor() {
  std::vector<VectorPath> paths = {VectorPath::kBaseline};
#if defined(__x86_64__)
  const bool avx2 = __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("popcnt") != 0 &&
                    __builtin_cpu_supports("bmi") != 0;
  if (avx2) paths.push_back(VectorPath::kAvx2);
  if (avx2 && __builtin_cpu_supports("avx512f") != 0) paths.push_back(VectorPath::kAvx512);
#endif
  return paths;
}

}  // namespace

std::span<const VectorPath> vector_paths() {
  static const std::vector<VectorPath> kPaths = paths_of_processor();
  return kPaths;
}

}  // namespace kilter
