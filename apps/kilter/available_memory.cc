// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/available_memory.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <string>

namespace kilter::app {
namespace {

std::optional<std::uint64_t> number_in(const char* file) {
  std::ifstream text(file);
  std::uint64_t number = 0;
  if (text >> number) return number;
  return std::nullopt;  // absent, or "max"
}

std::optional<std::uint64_t> available_to_all() {
  std::ifstream text("/proc/meminfo");
  std::string name, unit;
  std::uint64_t kilobytes = 0;
  while (text >> name >> kilobytes) {
    std::getline(text, unit);
    if (name == "MemAvailable:") return kilobytes * 1024;
  }
  return std::nullopt;
}

std::optional<std::uint64_t> left_by_control_group() {
  const auto limit = number_in("/sys/fs/cgroup/memory.max");
  const auto used = number_in("/sys/fs/cgroup/memory.current");
  if (!limit || !used) return std::nullopt;
  return *limit - std::min(*limit, *used);
}

}  // namespace

std::optional<std::size_t> available_memory() {
  const auto system = available_to_all();
  const auto group = left_by_control_group();
  if (!system && !group) return std::nullopt;
  return static_cast<std::size_t>(std::min(system.value_or(UINT64_MAX), group.value_or(UINT64_MAX)));
}

std::size_t memory_budget(std::size_t asked_bytes) {
  return asked_bytes != 0 ? asked_bytes : available_memory().value_or(0) / 2;
}

}  // namespace kilter::app
