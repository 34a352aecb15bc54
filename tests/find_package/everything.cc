// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <numeric>
#include <vector>

#include "kilter/base/error_catalog.h"
#include "kilter/base/parallel.h"
#include "kilter/base/version.h"

// The umbrella links every module and the libraries behind them; prints the version for the test to compare.
int main() {
  std::vector<int> squares(100);
  kilter::parallel_for(squares.size(), {.threads = 2}, [&](std::size_t i) { squares[i] = static_cast<int>(i * i); });
  const bool all_computed = std::accumulate(squares.begin(), squares.end(), 0) == 328350;
  std::printf("%s\n", kilter::kVersion.data());
  return all_computed && !kilter::error_catalog().empty() ? 0 : 1;
}
