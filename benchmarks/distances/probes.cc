// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "probes.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

#include "../processor_clock.h"

namespace kilter {
namespace {

constexpr int kRounds = 7;
constexpr std::size_t kLineWords = 8;

// Keeps a value, and what it came from, in the program.
void use(std::uint64_t value) { asm volatile("" : : "r"(value) : "memory"); }

template <typename Work>
double least_ns(const Work& work) {
  double least_s = std::numeric_limits<double>::max();
  for (int round = 0; round < kRounds; ++round) {
    const double start_s = processor_seconds();
    work();
    least_s = std::min(least_s, processor_seconds() - start_s);
  }
  return 1e9 * least_s;
}

}  // namespace

double cycles_per_ns() {
  constexpr int kAdditions = 20'000'000;
  return kAdditions / least_ns([] {
           std::uint64_t sum = 0;
           for (int i = 0; i < kAdditions; ++i) {
             ++sum;
             asm volatile("" : "+r"(sum));
           }
         });
}

double random_line_ns(std::size_t bytes) {
  const std::size_t lines = std::max<std::size_t>(bytes / (kLineWords * sizeof(std::uint64_t)), 1);
  const std::vector<std::uint64_t> memory(lines * kLineWords, 1);
  std::vector<std::uint32_t> order(1 << 20);
  std::mt19937 random(1);
  std::uniform_int_distribution<std::uint32_t> any(0, static_cast<std::uint32_t>(lines - 1));
  std::generate(order.begin(), order.end(), [&] { return any(random); });
  return least_ns([&] {
           std::array<std::uint64_t, 4> sums{};
           for (std::size_t i = 0; i < order.size(); i += sums.size()) {
             for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += memory[order[i + k] * kLineWords];
           }
           use(std::accumulate(sums.begin(), sums.end(), std::uint64_t{0}));
         }) /
         static_cast<double>(order.size());
}

double sequential_byte_ns(std::size_t bytes) {
  const std::vector<std::uint64_t> memory(std::max<std::size_t>(bytes / sizeof(std::uint64_t), 1), 1);
  const std::size_t times = std::max<std::size_t>((std::size_t{1} << 26) / bytes, 1);
  return least_ns([&] {
           for (std::size_t k = 0; k < times; ++k) use(std::accumulate(memory.begin(), memory.end(), std::uint64_t{k}));
         }) /
         static_cast<double>(times * memory.size() * sizeof(std::uint64_t));
}

}  // namespace kilter
