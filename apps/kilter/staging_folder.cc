// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/staging_folder.h"

#include <cerrno>
#include <cstdlib>
#include <set>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "kilter/io/file.h"

namespace kilter::app {
namespace {

namespace fs = std::filesystem;

// Inside the hidden folder, where what is replaced waits for its end.
constexpr const char* kEarlier = ".earlier";

tl::unexpected<Error> refuse(const std::error_code& error, const std::string& what, const fs::path& path) {
  const bool full = error == std::errc::no_space_on_device || error.value() == EDQUOT;
  return fail(full ? ErrorCode::kNoSpace : ErrorCode::kIo, fmt::format("{}: {}", what, error.message()), shown(path));
}

// The folder or, if it is missing as well, the highest one above it that is; nothing where it is there.
fs::path first_missing(const fs::path& folder) {
  fs::path missing;
  std::error_code error;
  for (fs::path path = folder; !path.empty() && fs::status(path, error).type() == fs::file_type::not_found;
       path = path.parent_path()) {
    missing = path;
  }
  return missing;
}

// From the folder up to `first_made`; one that holds something stays.
void remove_empty_folders(fs::path folder, const fs::path& first_made) {
  while (!first_made.empty() && !folder.empty()) {
    ::rmdir(folder.c_str());
    if (folder == first_made) return;
    folder = folder.parent_path();
  }
}

// Renames on one disk, and the folders that are made for them.
class Moves {
 public:
  std::error_code move(const fs::path& from, const fs::path& to) {
    const Move made = {from, to, first_missing(to.parent_path())};
    std::error_code error;
    fs::create_directories(to.parent_path(), error);
    if (!error) fs::rename(from, to, error);
    if (error) {
      remove_empty_folders(to.parent_path(), made.first_made);
    } else {
      moves_.push_back(made);
    }
    return error;
  }

  // The same where something else may have the name, which it can have back from `kept`. Nobody finds the name without
  // a file, unless the disk knows no hard links or the file is somebody else's.
  std::error_code put_in_place(const fs::path& from, const fs::path& to, const fs::path& kept) {
    std::error_code error;
    const fs::file_type found = fs::symlink_status(to, error).type();
    if (found == fs::file_type::not_found) return move(from, to);
    if (found == fs::file_type::directory) return std::make_error_code(std::errc::is_a_directory);
    const Move made = {to, kept, first_missing(kept.parent_path())};
    fs::create_directories(kept.parent_path(), error);
    if (!error) fs::create_hard_link(to, kept, error);
    if (error) {
      remove_empty_folders(kept.parent_path(), made.first_made);
      error = move(to, kept);
      return error ? error : move(from, to);
    }
    fs::rename(from, to, error);
    if (error) {
      ::unlink(kept.c_str());
      remove_empty_folders(kept.parent_path(), made.first_made);
    } else {
      moves_.push_back(made);
    }
    return error;
  }

  // The last one first. Whether all of them could be.
  bool take_back() {
    bool all = true;
    for (; !moves_.empty(); moves_.pop_back()) {
      const Move& made = moves_.back();
      std::error_code error;
      fs::rename(made.to, made.from, error);
      all = all && !error;
      remove_empty_folders(made.to.parent_path(), made.first_made);
    }
    return all;
  }

 private:
  struct Move {
    fs::path from;
    fs::path to;
    fs::path first_made;
  };
  std::vector<Move> moves_;
};

}  // namespace

StagingFolder::StagingFolder(fs::path folder, fs::path path, fs::path first_made)
    : folder_(std::move(folder)), path_(std::move(path)), first_made_(std::move(first_made)) {}

StagingFolder::StagingFolder(StagingFolder&& other) noexcept
    : folder_(std::move(other.folder_)),
      path_(std::exchange(other.path_, {})),
      first_made_(std::move(other.first_made_)) {}

StagingFolder::~StagingFolder() {
  if (path_.empty()) return;
  std::error_code error;
  fs::remove_all(path_, error);
  remove_empty_folders(folder_, first_made_);
}

Expected<StagingFolder> StagingFolder::make_in(const fs::path& folder) {
  std::error_code error;
  const fs::path first_made = first_missing(folder);
  fs::create_directories(folder, error);
  if (error) {
    remove_empty_folders(folder, first_made);
    return refuse(error, "cannot be made", folder);
  }
  std::string name = (folder / ".kilter-XXXXXX").native();
  if (::mkdtemp(name.data()) == nullptr) {
    error = {errno, std::generic_category()};
    remove_empty_folders(folder, first_made);
    return refuse(error, "nothing can be written into it", folder);
  }
  return StagingFolder(folder, name, first_made);
}

Expected<void> StagingFolder::try_name(const fs::path& name) const {
  std::error_code error;
  fs::create_directories((path_ / name).parent_path(), error);
  if (error) return refuse(error, "cannot be written", folder_ / name);
  const int file = ::open((path_ / name).c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (file < 0) return refuse({errno, std::generic_category()}, "cannot be written", folder_ / name);
  ::close(file);
  return {};
}

Expected<void> StagingFolder::write(const fs::path& name, std::string_view bytes) const {
  std::error_code error;
  fs::create_directories((path_ / name).parent_path(), error);
  if (error) return refuse(error, "cannot be written", folder_ / name);
  Expected<void> written = write_file_atomically(path_ / name, bytes);
  if (!written) written.error().where = shown(folder_ / name);
  return written;
}

Expected<void> StagingFolder::publish(const std::vector<fs::path>& names, const std::vector<fs::path>& earlier) {
  Moves moves;
  std::set<fs::path> folders;
  const auto give_up = [&](const std::error_code& error, const std::string& what, const fs::path& name) {
    auto refused = refuse(error, what, folder_ / name);
    if (moves.take_back()) return refused;
    std::error_code ignored;
    const bool is_kept = fs::exists(path_ / kEarlier, ignored);
    refused.value().hint =
        "some new files have their names and could not be taken back; " +
        (is_kept ? "what they replaced is in " + shown(std::exchange(path_, {}) / kEarlier) : "they replaced nothing");
    return refused;
  };
  for (const fs::path& name : earlier) {
    if (const auto error = moves.move(folder_ / name, path_ / kEarlier / name)) {
      return give_up(error, "cannot be replaced", name);
    }
  }
  for (const fs::path& name : names) {
    if (const auto error = moves.put_in_place(path_ / name, folder_ / name, path_ / kEarlier / name)) {
      return give_up(error, "cannot be written", name);
    }
    folders.insert((folder_ / name).parent_path());
  }
  for (const fs::path& folder : folders) sync_folder(folder);
  return {};
}

}  // namespace kilter::app
