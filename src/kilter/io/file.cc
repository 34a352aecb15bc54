// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <new>
#include <system_error>
#include <utility>

#include "kilter/io/large_pages.h"
#include "kilter/io/open_file.h"

namespace kilter {
namespace {

tl::unexpected<Error> refuse_output(int error, const std::filesystem::path& path) {
  const bool full = error == ENOSPC || error == EDQUOT || error == EFBIG;
  return fail(full ? ErrorCode::kNoSpace : ErrorCode::kIo, fmt::format("cannot be written: {}", reason(error)),
              shown(path));
}

// \return 0 or errno.
int write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t step = ::write(descriptor, bytes.data(), std::min(bytes.size(), kMaxStep));
    if (step < 0 && errno == EINTR) continue;
    if (step < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(step));
  }
  return 0;
}

// A fresh file in `folder` that no other process and no other thread of ours has. \return 0 or errno.
int create_beside(const std::filesystem::path& folder, std::filesystem::path& name, int& descriptor) {
  static std::atomic<unsigned> counter{0};
  do {
    name = folder / fmt::format(".kilter-{}-{}.part", ::getpid(), counter++);
    descriptor = open_retrying(name, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW, 0666);
  } while (descriptor < 0 && errno == EEXIST);
  return descriptor < 0 ? errno : 0;
}

std::string_view name_of(std::filesystem::file_type type) {
  switch (type) {
    case std::filesystem::file_type::regular:
      return "a file";
    case std::filesystem::file_type::directory:
      return "a folder";
    case std::filesystem::file_type::fifo:
      return "a pipe";
    case std::filesystem::file_type::socket:
      return "a socket";
    default:
      return "a device";
  }
}

Expected<void> expect_type(const std::filesystem::path& path, std::filesystem::file_type wanted) {
  const Expected<std::filesystem::file_type> type = type_at(path);
  if (!type) return pass_up(type.error());
  if (*type == wanted) return {};
  return fail(ErrorCode::kIo, fmt::format("expected {}, found {} of that name", name_of(wanted), name_of(*type)),
              shown(path), "give it another name, or move it away");
}

}  // namespace

Expected<ByteBuffer> ByteBuffer::allocate(std::size_t size) {
  ByteBuffer buffer;
  buffer.data_.reset(new (std::nothrow) char[size]);
  if (buffer.data_ == nullptr) return fail(ErrorCode::kOutOfMemory, fmt::format("{} bytes are not to be had", size));
  buffer.size_ = size;
  advise_large_pages(buffer.data(), size);
  return buffer;
}

Expected<ByteBuffer> read_file(const std::filesystem::path& path, std::uint64_t max_bytes) {
  const Expected<OpenFile> file = open_regular_file(path);
  if (!file) return pass_up(file.error());
  const std::uint64_t size = file->size;
  if (size > max_bytes) {
    return fail(ErrorCode::kUnsupported, fmt::format("the file has {} bytes; at most {} are read", size, max_bytes),
                shown(path));
  }
  Expected<ByteBuffer> buffer = ByteBuffer::allocate(static_cast<std::size_t>(size));
  if (!buffer) {
    buffer.error().where = shown(path);
    return buffer;
  }
  std::size_t done = 0;
  while (done < buffer->size()) {
    const ssize_t step =
        ::read(file->descriptor.number(), buffer->data() + done, std::min(buffer->size() - done, kMaxStep));
    if (step < 0 && errno == EINTR) continue;
    if (step < 0) return refuse_input(errno, path);
    if (step == 0) {
      return fail(ErrorCode::kTruncated,
                  fmt::format("the file shrank from {} to {} bytes while being read", size, done), shown(path));
    }
    done += static_cast<std::size_t>(step);
  }
  return buffer;
}

Expected<void> write_file_atomically(const std::filesystem::path& path, std::string_view bytes) {
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  std::filesystem::path part;
  int number = -1;
  if (const int error = create_beside(folder, part, number); error != 0) return refuse_output(error, path);
  Descriptor file(number);
  int error = write_all(file.number(), bytes);
  if (error == 0 && ::fsync(file.number()) != 0) error = errno;
  if (const int closing = file.close(); error == 0) error = closing;
  if (error == 0 && ::rename(part.c_str(), path.c_str()) != 0) error = errno;
  if (error != 0) {
    ::unlink(part.c_str());
    return refuse_output(error, path);
  }
  sync_folder(folder);
  return {};
}

Expected<std::vector<std::string>> list_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<std::string> names;
  std::filesystem::directory_iterator entry(folder, error);
  while (!error && entry != std::filesystem::directory_iterator()) {
    names.push_back(entry->path().filename().string());
    entry.increment(error);
  }
  if (error == std::errc::no_such_file_or_directory) {
    return fail(ErrorCode::kNotFound, "there is no such folder", shown(folder));
  }
  if (error) return fail(ErrorCode::kIo, fmt::format("cannot be listed: {}", error.message()), shown(folder));
  std::sort(names.begin(), names.end());
  return names;
}

bool is_folder(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::is_directory(path, error);
}

bool is_file(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error);
}

void sync_folder(const std::filesystem::path& folder) {
  const Descriptor handle(open_retrying(folder, O_RDONLY | O_DIRECTORY));
  if (handle.is_open()) static_cast<void>(::fsync(handle.number()));
}

Expected<std::filesystem::file_type> type_at(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_type type = std::filesystem::status(path, error).type();
  if (type == std::filesystem::file_type::not_found) {
    const std::filesystem::path target = std::filesystem::read_symlink(path, error);
    if (error) return fail(ErrorCode::kNotFound, "there is no such file or folder", shown(path));
    return fail(ErrorCode::kNotFound, fmt::format("a link to {}, where nothing is", shown(target)), shown(path),
                "mount the disk that it leads to, or mend the link");
  }
  if (!error) return type;
  return fail(ErrorCode::kIo, fmt::format("cannot be read: {}", error.message()), shown(path),
              error == std::errc::too_many_symbolic_link_levels ? "mend the link, it leads back to itself" : "");
}

Expected<void> expect_folder(const std::filesystem::path& path) {
  return expect_type(path, std::filesystem::file_type::directory);
}

Expected<void> expect_file(const std::filesystem::path& path) {
  return expect_type(path, std::filesystem::file_type::regular);
}

std::string some_of(const std::vector<std::string>& names) {
  constexpr std::size_t kShown = 5;
  std::string text;
  for (std::size_t i = 0; i < std::min(kShown, names.size()); ++i) {
    text += (i == 0 ? "" : ", ") + printable(names[i], 80);
  }
  return names.size() > kShown ? text + ", ..." : text;
}

std::string shown(const std::filesystem::path& path) { return printable(path.native(), 1024); }

}  // namespace kilter
