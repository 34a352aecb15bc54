// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// Any bytes named .db3 are refused with a printable reason, or give a robot whose clouds can be asked for.
#include <filesystem>
#include <fstream>

#include "bag_laws.h"
#include "kilter/io/bags/rosbag2_sqlite.h"

namespace {

// SQLite reads files only. One folder for each process, in memory where the system has such.
std::filesystem::path own_folder() {
  const bool has_memory = std::filesystem::is_directory("/dev/shm");
  std::string folder = has_memory ? "/dev/shm/kilter_XXXXXX" : "/tmp/kilter_XXXXXX";
  kilter_fuzz::demand(mkdtemp(folder.data()) != nullptr);
  return folder;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::filesystem::path folder = own_folder();
  // The fuzzer's own paths are relative to where it was started.
  const std::filesystem::path start = std::filesystem::current_path();
  std::filesystem::current_path(folder);
  const std::filesystem::path file = "fuzz.db3";
  std::ofstream(file, std::ios::binary | std::ios::trunc)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  kilter_fuzz::demand_lawful_bag(kilter::open_rosbag2_sqlite(file), size);
  std::filesystem::current_path(start);
  return 0;
}
