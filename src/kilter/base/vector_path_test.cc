// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/base/vector_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace kilter {
namespace {

bool has(VectorPath path) {
  return std::find(vector_paths().begin(), vector_paths().end(), path) != vector_paths().end();
}

TEST(VectorPath, BaselineIsAlwaysThereAndFirst) {
  ASSERT_FALSE(vector_paths().empty());
  EXPECT_EQ(vector_paths().front(), VectorPath::kBaseline);
}

TEST(VectorPath, EachKindOfProcessorHasItsOwn) {
#if defined(__aarch64__)
  EXPECT_EQ(vector_paths().back(), VectorPath::kNeon);
  EXPECT_FALSE(has(VectorPath::kAvx2) || has(VectorPath::kAvx512));
#else
  EXPECT_FALSE(has(VectorPath::kNeon));
#endif
}

#if defined(__x86_64__) && defined(__linux__)
std::set<std::string> flags_of_kernel() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("flags")) continue;
    std::istringstream words(line.substr(line.find(':') + 1));
    return {std::istream_iterator<std::string>(words), {}};
  }
  return {};
}

TEST(VectorPath, WideOnesAreThereWhereAllInstructionsAreThatTheyUse) {
  const std::set<std::string> flags = flags_of_kernel();
  if (flags.empty()) GTEST_SKIP() << "no /proc/cpuinfo";
  const auto all = [&](const std::vector<std::string>& names) {
    return std::all_of(names.begin(), names.end(), [&](const std::string& name) { return flags.count(name) == 1; });
  };
  const bool named = all({"avx2", "popcnt", "bmi1", "bmi2"});
  EXPECT_TRUE(named || !has(VectorPath::kAvx2));
  // Some kernels do not name LZCNT (abm) where it is.
  EXPECT_TRUE(has(VectorPath::kAvx2) || !named || !all({"abm"}));
  EXPECT_EQ(has(VectorPath::kAvx512), has(VectorPath::kAvx2) && all({"avx512f"}));
}
#endif

}  // namespace
}  // namespace kilter
