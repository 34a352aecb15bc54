// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/base/vector_path.h"

#include <vector>

namespace kilter {
namespace {

std::vector<VectorPath> paths_of_processor() {
  std::vector<VectorPath> paths = {VectorPath::kBaseline};
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) paths.push_back(VectorPath::kAvx2);
  if (__builtin_cpu_supports("avx512f")) paths.push_back(VectorPath::kAvx512);
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
