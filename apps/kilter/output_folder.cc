// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/output_folder.h"

#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

#include "kilter/io/file.h"

namespace kilter::app {
namespace {

namespace fs = std::filesystem;

tl::unexpected<Error> refuse(const fs::path& path, const std::string& message) {
  return fail(ErrorCode::kIo, message, shown(path), "name another folder with -o");
}

Expected<void> make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!error) return {};
  const bool full = error == std::errc::no_space_on_device;
  return fail(full ? ErrorCode::kNoSpace : ErrorCode::kIo, fmt::format("cannot be made: {}", error.message()),
              shown(folder));
}

}  // namespace

Expected<void> probe_output_folder(const fs::path& folder) {
  if (folder.empty()) return refuse(folder, "expected the name of a folder to write to, found nothing");
  fs::path existing = folder.lexically_normal();
  std::error_code error;
  while (!existing.empty() && fs::symlink_status(existing, error).type() == fs::file_type::not_found) {
    existing = existing.parent_path();
  }
  if (existing.empty()) existing = ".";
  if (!fs::is_directory(existing, error))
    return refuse(existing, "expected a folder to write to, found something else");
  if (::access(existing.c_str(), W_OK | X_OK) != 0) return refuse(existing, "this folder may not be written to");
  return {};
}

Expected<void> write_output_folder(const fs::path& folder, const std::vector<OutputFile>& files) {
  if (auto made = make_folder(folder); !made) return made;
  for (const OutputFile& file : files) {
    const fs::path path = folder / file.name;
    if (file.name.has_parent_path()) {
      std::error_code error;
      if (fs::is_symlink(fs::symlink_status(path.parent_path(), error))) {
        return refuse(path.parent_path(), "this is a symlink, and nothing is written through it");
      }
      if (auto made = make_folder(path.parent_path()); !made) return made;
    }
    if (auto written = write_file_atomically(path, file.bytes); !written) return written;
  }
  return {};
}

}  // namespace kilter::app
