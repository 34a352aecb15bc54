// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/open_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <string_view>
#include <system_error>

#include "kilter/io/file.h"

namespace kilter {
namespace {

std::string_view kind_of(mode_t mode) {
  if (S_ISDIR(mode)) return "a folder";
  if (S_ISFIFO(mode)) return "a pipe";
  if (S_ISSOCK(mode)) return "a socket";
  return "a device";
}

}  // namespace

int open_retrying(const std::filesystem::path& path, int flags, mode_t mode) {
  int number = -1;
  do {
    number = ::open(path.c_str(), flags | O_CLOEXEC, mode);
  } while (number < 0 && errno == EINTR);
  return number;
}

std::string reason(int error) { return std::generic_category().message(error); }

tl::unexpected<Error> refuse_input(int error, const std::filesystem::path& path) {
  if (error == ENOENT || error == ENOTDIR) return fail(ErrorCode::kNotFound, "there is no such file", shown(path));
  return fail(ErrorCode::kIo, fmt::format("cannot be read: {}", reason(error)), shown(path));
}

Expected<OpenFile> open_regular_file(const std::filesystem::path& path) {
  // Non-blocking, since opening a pipe would otherwise wait for its writer.
  Descriptor file(open_retrying(path, O_RDONLY | O_NONBLOCK | O_NOCTTY));
  if (!file.is_open()) return refuse_input(errno, path);
  struct stat info {};
  if (::fstat(file.number(), &info) != 0) return refuse_input(errno, path);
  if (!S_ISREG(info.st_mode)) {
    return fail(ErrorCode::kIo, fmt::format("expected a regular file, found {}", kind_of(info.st_mode)), shown(path));
  }
  return OpenFile{std::move(file), static_cast<std::uint64_t>(info.st_size)};
}

}  // namespace kilter
