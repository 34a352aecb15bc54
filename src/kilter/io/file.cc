// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <new>
#include <system_error>
#include <utility>

#include "kilter/io/large_pages.h"

namespace kilter {
namespace {

// Linux moves at most 2 GiB a call; smaller steps also keep a signal's delay short.
constexpr std::size_t kMaxStep = std::size_t{1} << 28;

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor(Descriptor&&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  Descriptor& operator=(Descriptor&&) = delete;
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }

  [[nodiscard]] int number() const { return number_; }
  [[nodiscard]] bool is_open() const { return number_ >= 0; }
  /// For writers, who must know whether the last bytes arrived. \return 0 or errno.
  int close() { return ::close(std::exchange(number_, -1)) == 0 ? 0 : errno; }

 private:
  int number_;
};

std::string reason(int error) { return std::generic_category().message(error); }

int open_retrying(const std::filesystem::path& path, int flags, mode_t mode = 0) {
  int number = -1;
  do {
    number = ::open(path.c_str(), flags | O_CLOEXEC, mode);
  } while (number < 0 && errno == EINTR);
  return number;
}

tl::unexpected<Error> refuse_input(int error, const std::filesystem::path& path) {
  if (error == ENOENT || error == ENOTDIR) return fail(ErrorCode::kNotFound, "there is no such file", shown(path));
  return fail(ErrorCode::kIo, fmt::format("cannot be read: {}", reason(error)), shown(path));
}

tl::unexpected<Error> refuse_output(int error, const std::filesystem::path& path) {
  const bool full = error == ENOSPC || error == EDQUOT || error == EFBIG;
  return fail(full ? ErrorCode::kNoSpace : ErrorCode::kIo, fmt::format("cannot be written: {}", reason(error)),
              shown(path));
}

std::string_view kind_of(mode_t mode) {
  if (S_ISDIR(mode)) return "a folder";
  if (S_ISFIFO(mode)) return "a pipe";
  if (S_ISSOCK(mode)) return "a socket";
  return "a device";
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

// The rename itself must outlive a power cut too. A folder that cannot be synced is no reason to fail.
void sync_folder(const std::filesystem::path& folder) {
  const Descriptor handle(open_retrying(folder, O_RDONLY | O_DIRECTORY));
  if (handle.is_open()) static_cast<void>(::fsync(handle.number()));
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
  // Non-blocking, since opening a pipe would otherwise wait for its writer.
  const Descriptor file(open_retrying(path, O_RDONLY | O_NONBLOCK | O_NOCTTY));
  if (!file.is_open()) return refuse_input(errno, path);
  struct stat info {};
  if (::fstat(file.number(), &info) != 0) return refuse_input(errno, path);
  if (!S_ISREG(info.st_mode)) {
    return fail(ErrorCode::kIo, fmt::format("expected a regular file, found {}", kind_of(info.st_mode)), shown(path));
  }
  const auto size = static_cast<std::uint64_t>(info.st_size);
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
    const ssize_t step = ::read(file.number(), buffer->data() + done, std::min(buffer->size() - done, kMaxStep));
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
