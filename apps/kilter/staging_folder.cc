// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/staging_folder.h"

#include <cerrno>
#include <cstdlib>
#include <set>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "kilter/io/file.h"

namespace kilter::app {
namespace {

namespace fs = std::filesystem;

tl::unexpected<Error> refuse(const std::error_code& error, const std::string& what, const fs::path& path) {
  const bool full = error == std::errc::no_space_on_device || error.value() == EDQUOT;
  return fail(full ? ErrorCode::kNoSpace : ErrorCode::kIo, fmt::format("{}: {}", what, error.message()), shown(path));
}

}  // namespace

StagingFolder::StagingFolder(fs::path folder, fs::path path, bool made_folder)
    : folder_(std::move(folder)), path_(std::move(path)), made_folder_(made_folder) {}

StagingFolder::StagingFolder(StagingFolder&& other) noexcept
    : folder_(std::move(other.folder_)), path_(std::exchange(other.path_, {})), made_folder_(other.made_folder_) {}

StagingFolder::~StagingFolder() {
  if (path_.empty()) return;
  std::error_code error;
  fs::remove_all(path_, error);
  if (made_folder_ && fs::is_empty(folder_, error)) fs::remove(folder_, error);
}

Expected<StagingFolder> StagingFolder::make_in(const fs::path& folder) {
  std::error_code error;
  const bool made_folder = fs::create_directories(folder, error);
  if (error) return refuse(error, "cannot be made", folder);
  std::string name = (folder / ".kilter-XXXXXX").native();
  if (::mkdtemp(name.data()) == nullptr) {
    error = {errno, std::generic_category()};
    if (std::error_code ignored; made_folder) fs::remove(folder, ignored);
    return refuse(error, "nothing can be written into it", folder);
  }
  return StagingFolder(folder, name, made_folder);
}

Expected<void> StagingFolder::write(const fs::path& name, std::string_view bytes) const {
  std::error_code error;
  fs::create_directories((path_ / name).parent_path(), error);
  if (error) return refuse(error, "cannot be written", folder_ / name);
  Expected<void> written = write_file_atomically(path_ / name, bytes);
  if (!written) written.error().where = shown(folder_ / name);
  return written;
}

Expected<void> StagingFolder::publish(const std::vector<fs::path>& names) const {
  std::set<fs::path> folders;
  for (const fs::path& name : names) {
    const fs::path path = folder_ / name;
    std::error_code error;
    fs::create_directories(path.parent_path(), error);
    if (error) return refuse(error, "cannot be made", path.parent_path());
    fs::rename(path_ / name, path, error);
    if (error) return refuse(error, "cannot be written", path);
    folders.insert(path.parent_path());
  }
  for (const fs::path& folder : folders) sync_folder(folder);
  return {};
}

}  // namespace kilter::app
