// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/available_memory.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>

namespace kilter::app {
namespace {

// A budget that nobody asked for is never less than this, however little is free by then. [bytes]
constexpr std::uint64_t kLeastBudget = std::uint64_t{256} << 20;

std::optional<std::uint64_t> number_in(const std::filesystem::path& file) {
  std::ifstream text(file);
  std::uint64_t number = 0;
  if (text >> number) return number;
  return std::nullopt;  // absent, or "max"
}

// The number behind a name, lines of which a file consists; what follows it on its line is passed over.
std::optional<std::uint64_t> number_of(const std::filesystem::path& file, std::string_view wanted) {
  std::ifstream text(file);
  std::string name, rest;
  std::uint64_t number = 0;
  while (text >> name >> number) {
    std::getline(text, rest);
    if (name == wanted) return number;
  }
  return std::nullopt;
}

std::optional<std::uint64_t> available_to_all(const std::filesystem::path& root) {
  const auto kilobytes = number_of(root / "proc/meminfo", "MemAvailable:");
  return kilobytes ? std::optional(*kilobytes * 1024) : std::nullopt;
}

// How a version of control groups calls what it tells.
struct ControlGroup {
  const char* limit;
  const char* used;
  const char* details;
  const char* reclaimable;  // files that were read, which the system lets go where memory is wanted
};
constexpr std::array<ControlGroup, 2> kControlGroups = {{
    {"sys/fs/cgroup/memory.max", "sys/fs/cgroup/memory.current", "sys/fs/cgroup/memory.stat", "inactive_file"},
    {"sys/fs/cgroup/memory/memory.limit_in_bytes", "sys/fs/cgroup/memory/memory.usage_in_bytes",
     "sys/fs/cgroup/memory/memory.stat", "total_inactive_file"},
}};

std::optional<std::uint64_t> left_by_control_group(const std::filesystem::path& root) {
  for (const ControlGroup& group : kControlGroups) {
    const auto limit = number_in(root / group.limit);
    const auto used = number_in(root / group.used);
    if (!limit || !used) continue;
    const std::uint64_t reclaimable = number_of(root / group.details, group.reclaimable).value_or(0);
    const std::uint64_t taken = *used - std::min(*used, reclaimable);
    return *limit - std::min(*limit, taken);
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::size_t> available_memory(const std::filesystem::path& root) {
  const auto system = available_to_all(root);
  const auto group = left_by_control_group(root);
  if (!system && !group) return std::nullopt;
  return static_cast<std::size_t>(std::min(system.value_or(UINT64_MAX), group.value_or(UINT64_MAX)));
}

std::size_t memory_budget(std::size_t asked_bytes, const std::filesystem::path& root) {
  if (asked_bytes != 0) return asked_bytes;
  const auto available = available_memory(root);
  return available ? static_cast<std::size_t>(std::max<std::uint64_t>(*available / 2, kLeastBudget)) : 0;
}

}  // namespace kilter::app
