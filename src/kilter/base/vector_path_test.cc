// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/base/vector_path.h"

#include <gtest/gtest.h>

#include <algorithm>

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

}  // namespace
}  // namespace kilter
