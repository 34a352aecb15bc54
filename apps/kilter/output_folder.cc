// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apps/kilter/output_folder.h"

#include <cerrno>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "apps/kilter/signals.h"
#include "apps/kilter/staging_folder.h"
#include "kilter/io/file.h"

namespace kilter::app {
namespace {

namespace fs = std::filesystem;

tl::unexpected<Error> refuse(const fs::path& path, const std::string& message) {
  return fail(ErrorCode::kIo, message, shown(path), "name another folder with -o");
}

// In /tmp, say, everybody may write, but nobody may replace what is another's.
bool is_kept_by_its_owner(const fs::path& file) {
  struct stat entry {};
  struct stat folder {};
  const fs::path parent = file.has_parent_path() ? file.parent_path() : ".";
  if (::lstat(file.c_str(), &entry) != 0 || ::stat(parent.c_str(), &folder) != 0) return false;
  const uid_t user = ::geteuid();
  return (folder.st_mode & S_ISVTX) != 0 && user != 0 && user != entry.st_uid && user != folder.st_uid;
}

constexpr const char* kKeptByItsOwner =
    "this is another user's, and the folder's sticky bit lets nobody else replace it";

// A file can get its name where a file or a link stands already; a folder inside `folder` must be one.
Expected<void> check_name(const fs::path& folder, const fs::path& name) {
  std::error_code error;
  if (name.has_parent_path()) {
    const fs::path inner = folder / name.parent_path();
    const fs::file_type found = fs::symlink_status(inner, error).type();
    if (found == fs::file_type::symlink) return refuse(inner, "this is a symlink, and nothing is written through it");
    if (found != fs::file_type::directory && found != fs::file_type::not_found) {
      return refuse(inner, "expected a folder to write to, found something else");
    }
  }
  if (fs::symlink_status(folder / name, error).type() == fs::file_type::directory) {
    return refuse(folder / name, "a folder stands where a file is to be written");
  }
  if (is_kept_by_its_owner(folder / name)) return refuse(folder / name, kKeptByItsOwner);
  return {};
}

}  // namespace

Expected<void> probe_output_folder(const fs::path& folder, const std::vector<fs::path>& names) {
  if (folder.empty()) return refuse(folder, "expected the name of a folder to write to, found nothing");
  fs::path existing = folder.lexically_normal();
  std::error_code error;
  while (!existing.empty() && fs::symlink_status(existing, error).type() == fs::file_type::not_found) {
    existing = existing.parent_path();
  }
  if (existing.empty()) existing = ".";
  const fs::file_type found = fs::status(existing, error).type();
  if (found == fs::file_type::none) return refuse(existing, "nothing can be written there: " + error.message());
  if (found != fs::file_type::directory) {
    return refuse(existing, "expected a folder to write to, found something else");
  }
  for (const fs::path& name : names) {
    if (auto fit = check_name(folder, name); !fit) return fit;
  }
  Expected<StagingFolder> made = StagingFolder::make_in(folder);
  if (!made) {
    made.error().hint = "name another folder with -o";
    return pass_up(made.error());
  }
  for (const fs::path& name : names) {
    Expected<void> fit = made->try_name(name);
    if (fit) continue;
    fit.error().hint = "name another folder with -o";
    // The folders in it and the maps are called as robots are.
    if (name.has_parent_path()) fit.error().hint += ", or call the robot otherwise: NAME=PATH";
    return fit;
  }
  return {};
}

Expected<void> check_output_file(const fs::path& file, std::string_view extension,
                                 const std::vector<fs::path>& inputs) {
  if (file.extension() != extension) {
    return fail(ErrorCode::kUsage, fmt::format("expected a file that ends in {}", extension), "-o " + shown(file));
  }
  for (const fs::path& input : inputs) {
    std::error_code error;
    if (!fs::equivalent(file, input, error)) continue;
    return fail(ErrorCode::kUsage, fmt::format("{} is read and would be overwritten", shown(input)),
                "-o " + shown(file), "name another file with -o");
  }
  return {};
}

Expected<void> probe_output_file(const fs::path& file) {
  const auto refuse_file = [](const fs::path& path, std::string message) {
    return fail(ErrorCode::kIo, std::move(message), shown(path), "name another file with -o");
  };
  const fs::path folder = file.has_parent_path() ? file.parent_path() : ".";
  if (Expected<void> there = expect_folder(folder); !there) {
    there.error().hint = "make the folder first, or name another file with -o";
    return there;
  }
  std::error_code error;
  const fs::file_type found = fs::symlink_status(file, error).type();
  if (found == fs::file_type::none) return refuse_file(file, "cannot be written: " + error.message());
  if (found == fs::file_type::directory) return refuse_file(file, "a folder stands where a file is to be written");
  if (is_kept_by_its_owner(file)) return refuse_file(file, kKeptByItsOwner);
  if (::access(folder.c_str(), W_OK | X_OK) == 0) return {};
  error = {errno, std::generic_category()};
  return refuse_file(folder, "nothing can be written into it: " + error.message());
}

Expected<void> write_output_folder(const fs::path& folder, const std::vector<OutputFile>& files) {
  std::vector<fs::path> names;
  for (const OutputFile& file : files) {
    if (auto fit = check_name(folder, file.name); !fit) return fit;
    names.push_back(file.name);
  }
  Expected<StagingFolder> staging = StagingFolder::make_in(folder);
  if (!staging) return pass_up(staging.error());
  for (const OutputFile& file : files) {
    if (stop_flag()) break;
    if (auto written = staging->write(file.name, file.bytes); !written) return written;
  }
  if (stop_flag()) return pass_up(stopped());
  return staging->publish(names);
}

}  // namespace kilter::app
