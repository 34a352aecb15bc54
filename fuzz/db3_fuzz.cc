// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
// Any bytes named .db3 are refused with a printable reason, or give a robot whose clouds can be asked for.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

#include "bag_laws.h"
#include "kilter/io/bags/rosbag2_sqlite.h"

namespace {

// SQLite reads files only. One folder for each process, in memory where the system has such, removed at its end.
struct OwnFolder {
  std::string path = std::filesystem::is_directory("/dev/shm") ? "/dev/shm/kilter_XXXXXX" : "/tmp/kilter_XXXXXX";

  OwnFolder() { kilter_fuzz::demand(mkdtemp(path.data()) != nullptr); }
  OwnFolder(const OwnFolder&) = delete;
  OwnFolder& operator=(const OwnFolder&) = delete;
  ~OwnFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const OwnFolder folder;
  // The fuzzer's own paths are relative to where it was started.
  const std::filesystem::path start = std::filesystem::current_path();
  std::filesystem::current_path(folder.path);
  const std::filesystem::path file = "fuzz.db3";
  std::ofstream(file, std::ios::binary | std::ios::trunc)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  kilter_fuzz::demand_lawful_bag(kilter::open_rosbag2_sqlite(file), size);
  std::filesystem::current_path(start);
  return 0;
}
