// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/available_memory.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

namespace kilter::app {
namespace {

constexpr std::size_t kMega = std::size_t{1} << 20;

// A folder in the place of the file system's root.
class AvailableMemory : public testing::Test {
 protected:
  void SetUp() override {
    root_ = std::filesystem::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::remove_all(root_);
  }
  void TearDown() override { std::filesystem::remove_all(root_); }

  void write(const std::string& file, const std::string& text) const {
    std::filesystem::create_directories((root_ / file).parent_path());
    std::ofstream(root_ / file) << text;
  }
  void write_system(std::size_t available) const {
    write("proc/meminfo", "MemTotal:       65536000 kB\nMemFree:  100 kB\nMemAvailable: " +
                              std::to_string(available / 1024) + " kB\nBuffers: 1 kB\n");
  }

  std::filesystem::path root_;
};

TEST_F(AvailableMemory, IsTheSystemsWhereNoGroupLimitsIt) {
  EXPECT_EQ(available_memory(root_), std::nullopt);
  EXPECT_EQ(memory_budget(0, root_), 0U);
  write_system(4096 * kMega);
  write("sys/fs/cgroup/memory.max", "max\n");
  write("sys/fs/cgroup/memory.current", "123456\n");
  EXPECT_EQ(available_memory(root_), 4096 * kMega);
  EXPECT_EQ(memory_budget(0, root_), 2048 * kMega);
  EXPECT_EQ(memory_budget(7 * kMega, root_), 7 * kMega);
}

TEST_F(AvailableMemory, OfAGroupLeavesFilesThatWereReadOut) {
  write_system(64000 * kMega);
  write("sys/fs/cgroup/memory.max", std::to_string(8192 * kMega));
  write("sys/fs/cgroup/memory.current", std::to_string(8191 * kMega));
  write("sys/fs/cgroup/memory.stat",
        "anon 1000\nfile 2000\ninactive_file " + std::to_string(7000 * kMega) + "\nactive_file 5\n");
  EXPECT_EQ(available_memory(root_), 7001 * kMega);
}

TEST_F(AvailableMemory, OfTheFirstVersionsGroupsToo) {
  write_system(64000 * kMega);
  write("sys/fs/cgroup/memory/memory.limit_in_bytes", std::to_string(2048 * kMega));
  write("sys/fs/cgroup/memory/memory.usage_in_bytes", std::to_string(1024 * kMega));
  write("sys/fs/cgroup/memory/memory.stat", "cache 3\ntotal_inactive_file " + std::to_string(24 * kMega) + "\n");
  EXPECT_EQ(available_memory(root_), 1048 * kMega);
}

// Nothing left is not the same as no limit.
TEST_F(AvailableMemory, GivesABudgetEvenWhereNothingIsLeft) {
  write_system(64000 * kMega);
  write("sys/fs/cgroup/memory.max", std::to_string(1024 * kMega));
  write("sys/fs/cgroup/memory.current", std::to_string(1024 * kMega));
  EXPECT_EQ(available_memory(root_), 0U);
  EXPECT_EQ(memory_budget(0, root_), 256 * kMega);
}

}  // namespace
}  // namespace kilter::app
